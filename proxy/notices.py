"""Has the kernel tell when something happens to files, so that nobody has to look all the time.

It only says when to look: it tells nothing where a file system does not know of changes, as over a network, and too
much where others write to the same folder.

Source: inotify(7).
"""

import ctypes
import os
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

_CLOSED_AFTER_WRITING, _MOVED, _CREATED, _DELETED, _ATTRIBUTES = 0x8, 0xC0, 0x100, 0x200, 0x4
_ANYTHING = _CLOSED_AFTER_WRITING | _MOVED | _CREATED | _DELETED | _ATTRIBUTES
_LARGEST = 65536
"""So much of what it tells is read at a time [B]; what it is does not matter."""


class Notices:
    """Notices that something happened to files, or in their folders. Where the kernel has no room for it, never."""

    def __init__(self) -> None:
        self._libc = ctypes.CDLL(None)
        self._number = int(self._libc.inotify_init1(os.O_NONBLOCK | os.O_CLOEXEC))

    def fileno(self) -> int:
        """Return what becomes readable with a notice; less than 0: nothing does."""
        return self._number

    def watch(self, paths: Iterable[Path]) -> None:
        """Notice what happens to these from now on, as far as they are there; also what was watched before."""
        for path in paths:
            for each in (path, path.parent):
                self._libc.inotify_add_watch(self._number, os.fsencode(each), _ANYTHING)

    def take(self) -> bool:
        """Whether there were notices since the last time."""
        with suppress(OSError):
            return bool(os.read(self._number, _LARGEST))
        return False

    def close(self) -> None:
        """Notice nothing more."""
        with suppress(OSError):
            os.close(self._number)
