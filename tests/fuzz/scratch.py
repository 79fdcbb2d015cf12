"""A folder for what is written to be read: targets that take files get them from there."""

import atexit
import shutil
import tempfile
from functools import cache
from pathlib import Path


@cache
def scratch() -> Path:
    """Return the folder of this process, which goes when it ends."""
    folder = tempfile.mkdtemp(prefix="sendworthy-fuzz-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return Path(folder)
