"""A private place where a main session listens for its mirror session."""

import fcntl
import os
import shutil
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Any

from proxy.bridge.sessions import PLACE, PRIVATE, merged
from proxy.errors import SessionError

_LOCK = "lock"
MEMORY = "/dev/shm"  # noqa: S108 - its folder there is nobody else's
"""Where there is room as long as there is memory."""


class PrivateEndpoint:
    """A folder with two sockets. Folders of processes that were killed are removed when the next one opens.

    Zenoh announces every place where it listens, and other daemons of this machine would link here, where their links
    count for nothing. So what it is told leads here from this process alone.
    """

    def __init__(self) -> None:
        self._folder = _made()
        _sweep(self._folder.parent)
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


def _made() -> Path:
    """Make a folder where one can be made. Raises SessionError."""
    failed: OSError | None = None
    for place in (None, *_others()):  # None: where temporary files go
        try:
            return Path(tempfile.mkdtemp(prefix=f"new-{PRIVATE}", dir=place))
        except OSError as error:
            failed = error
    raise SessionError(f"no folder can be made for sockets: {failed}; let TMPDIR name a place with room") from failed


def _others() -> tuple[str, ...]:
    """Return where a folder may be made when the disk is full or may not be written to: in memory."""
    return (*filter(None, os.environ.get("RUNTIME_DIRECTORY", "").split(":")), MEMORY)


def _sweep(place: Path) -> None:
    """Remove the folders that nobody holds a lock in any more."""
    for folder in place.glob(f"{PRIVATE}*"):
        with suppress(OSError), (folder / _LOCK).open("r+") as lock:  # another user's, or gone meanwhile
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            shutil.rmtree(folder, ignore_errors=True)
