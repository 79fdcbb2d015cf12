"""Which Sendworthy this is."""

import sys
from pathlib import Path


def version() -> str:
    """Return the version that is installed.

    Installers name a folder after it. `importlib.metadata` reads what is in there, and for that loads so much that
    every daemon would be 1.7 MB larger: it is only asked where there is no such folder.
    """
    for folder in sys.path:
        for found in Path(folder).glob("sendworthy-*.dist-info"):
            return found.name.removeprefix("sendworthy-").removesuffix(".dist-info")
    from importlib import metadata  # noqa: PLC0415 - large

    return metadata.version("sendworthy")
