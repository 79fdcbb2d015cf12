"""Notices when files change: written in place, renamed over, behind symbolic links, gone or unreadable."""

from collections.abc import Callable, Iterable
from pathlib import Path

from utility_specs.loader import spec_files

Signature = tuple[tuple[str, int, int, int, int], ...]
"""Of every file: its path, inode, size, and when content and inode changed last [ns]."""


DEFINITIONS = ("*.msg", "msg/*.msg")
"""Definitions of messages, beside the specs and where ROS 2 has them: `msg/Battery.msg`."""


def signature(paths: Iterable[Path]) -> Signature:
    """Return what tells one state of files, of the `*.toml` in folders, and of definitions of messages, from another.

    Never raises.
    """
    return tuple(sorted(entry for path in paths for entry in _entries(path)))


class FileWatch:
    """Compares files with what they were; `paths` says which those are now.

    They were as `known` says when they were read, or else as they are now.
    """

    def __init__(self, paths: Callable[[], Iterable[Path]], known: Signature | None = None) -> None:
        self._paths = paths
        self._known = self._last = signature(paths()) if known is None else known

    def look(self) -> bool:
        """Whether the files changed and then stayed as they are since the last look; says so once.

        So a file that is being written is left alone until its writer is done or pauses.
        """
        before, self._last = self._last, signature(self._paths())
        if self._last == self._known or self._last != before:
            return False
        self._known = self._last
        return True

    @property
    def changing(self) -> bool:
        """Whether the files had changed at the last look, so that the next one may tell."""
        return self._last != self._known

    def note(self) -> None:
        """Take the files as they are now for known."""
        self._known = self._last = signature(self._paths())


def _entries(path: Path) -> list[tuple[str, int, int, int, int]]:
    try:
        folder = path if path.is_dir() else path.parent
        files = [*spec_files(path), *(file for each in DEFINITIONS for file in folder.glob(each))]
    except OSError:
        files = [path]
    return [_entry(file) for file in files]


def _entry(file: Path) -> tuple[str, int, int, int, int]:
    """Describe what the path leads to; all zero when it leads nowhere."""
    try:
        found = file.stat()
    except (OSError, ValueError):
        return str(file), 0, 0, 0, 0
    return str(file), found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns
