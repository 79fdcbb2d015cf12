"""The folder with a robot's recordings, and the bound on what they take."""

import re
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path

_FORBIDDEN = re.compile(r"[^\w.+-]")


class RecordingFolder:
    """Names new files of a robot, `<robot>-<when the recording began>-<number>.mcap`, and removes the oldest ones.

    All recordings of the robot in there take at most `disk` [B]; nothing else is touched.
    """

    def __init__(self, path: Path, robot: str, disk: int, began: float) -> None:
        self.path = path.absolute()
        self._disk = disk
        name = _FORBIDDEN.sub("_", robot)
        self._stem = f"{name}-{datetime.fromtimestamp(began, UTC):%Y%m%dT%H%M%SZ}"
        self._own = re.compile(rf"{re.escape(name)}-\d{{8}}T\d{{6}}Z-\d{{4,}}\.mcap")
        self._number = 0

    def next(self, room: int) -> Path:
        """Return the path of the next file, which is new, with so much room for it [B]. Raises OSError."""
        self.path.mkdir(parents=True, exist_ok=True)
        self._make(room)
        while True:
            self._number += 1
            path = self.path / f"{self._stem}-{self._number:04}.mcap"
            if not path.exists():
                return path

    def _make(self, room: int) -> None:
        """Remove the oldest files until there is so much room within the bound.

        Names tell which are older, but files of this recording come last: a robot that boots without a clock names them
        as the oldest of all.
        """
        sizes = dict[Path, int]()
        for path in self.path.iterdir():
            if self._own.fullmatch(path.name):
                with suppress(FileNotFoundError):
                    sizes[path] = path.stat().st_size
        used = sum(sizes.values())
        for path in sorted(sizes, key=self._age):
            if used + room <= self._disk:
                return
            path.unlink(missing_ok=True)
            used -= sizes[path]

    def _age(self, path: Path) -> tuple[bool, str, int, str]:
        """Return what sorts the files of the robot, the oldest first."""
        recording, began, _ = path.name.rsplit("-", 2)
        return f"{recording}-{began}" == self._stem, began, len(path.name), path.name
