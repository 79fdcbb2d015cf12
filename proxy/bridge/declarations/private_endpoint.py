"""A private place where a main session listens for its mirror session."""

import fcntl
import os
import shutil
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Any

from proxy.bridge.sessions import PLACE, PRIVATE, merged

_LOCK = "lock"


class PrivateEndpoint:
    """A folder with two sockets. Folders of processes that were killed are removed when the next one opens.

    Zenoh announces every place where it listens, and other daemons of this machine would link here, where their links
    count for nothing. So what it is told leads here from this process alone.
    """

    def __init__(self) -> None:
        _sweep()
        self._folder = Path(tempfile.mkdtemp(prefix=f"new-{PRIVATE}"))
        self._lock = (self._folder / _LOCK).open("w")
        fcntl.flock(self._lock, fcntl.LOCK_EX)
        # Only now it has the name of those that are swept: nobody finds it unlocked while we live.
        self._folder = self._folder.rename(self._folder.with_name(self._folder.name.removeprefix("new-")))
        self._number = os.open(self._folder, os.O_PATH | os.O_DIRECTORY)
        self.main = self._folder / self._folder.name.removeprefix(PRIVATE)
        self.tap = self._folder / "tap"

    def added_to(self, options: dict[str, Any]) -> dict[str, Any]:
        """Return the options of a main session, which listens here too."""
        place = f"{PLACE}{self._number}/{self.main.name}"
        here = {"endpoints": [*options["listen"]["endpoints"], place]}
        return merged(options, {"listen": here})

    def close(self) -> None:
        """Remove the place."""
        shutil.rmtree(self._folder, ignore_errors=True)
        os.close(self._number)
        self._lock.close()


def _sweep() -> None:
    """Remove the folders that nobody holds a lock in any more."""
    for folder in Path(tempfile.gettempdir()).glob(f"{PRIVATE}*"):
        with suppress(OSError), (folder / _LOCK).open("r+") as lock:  # another user's, or gone meanwhile
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            shutil.rmtree(folder, ignore_errors=True)
