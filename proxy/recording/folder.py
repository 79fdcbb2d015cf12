"""The folder with a robot's recordings, and the bound on what they take."""

import re
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path

from proxy.recording.tuning import TUNING

_FORBIDDEN = re.compile(r"[^\w.+-]")


class RecordingFolder:
    """Names new files of a robot, `<robot>-<when the recording began>-<number>.mcap`, and removes the oldest ones.

    All recordings of the robot in there take at most `disk` [B]; nothing else is touched.
    """

    def __init__(self, path: Path, robot: str, disk: int, began: float) -> None:
        self.path = path.absolute()
        self._disk = disk
        self._name = _FORBIDDEN.sub("_", robot)
        self._began = began
        self._late = 0.0
        """What the wall clock was set by that names do not tell [s]."""
        self._own = re.compile(rf"{re.escape(self._name)}-\d{{8}}T\d{{6}}Z-\d{{4,}}\.mcap")
        self._number = 0
        self._stems = {self._stem}

    def set_clock(self, seconds: float) -> None:
        """The wall clock was set by so much: by it the recording began then, as later files say [s]."""
        self._late += seconds
        if abs(self._late) > TUNING.step:
            self._began, self._late = self._began + self._late, 0.0
            self._stems.add(self._stem)

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

        Names tell which are older, but files of this recording come last, by their numbers: a robot that boots without
        a clock names the first of them as the oldest of all.
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
        stem, _, number = path.stem.rpartition("-")
        own = stem in self._stems
        return own, "" if own else stem, int(number), path.name

    @property
    def _stem(self) -> str:
        """What names begin with."""
        return f"{self._name}-{datetime.fromtimestamp(self._began, UTC):%Y%m%dT%H%M%SZ}"
