"""The missions of the report, flown once each: what happened is kept in files, so that one can go on another time."""

import json
import os
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from studies.demo.events import Event, Publish, read_events, write_events
from studies.demo.nodes import DOWNSAMPLED, RANDOM, WITH, WITHOUT
from studies.demo.phase import Conditions, run_phase
from studies.demo.world import moment, schedule

WAYS = WITHOUT, DOWNSAMPLED, RANDOM, WITH
"""In the order of the runs: by what the first one publishes the others are tuned."""
SECONDS = 30.0
SEED = 1
EACH = 3e6
"""What the camera of a robot offers, roughly [bit/s]."""


@dataclass(frozen=True, slots=True)
class Mission:
    """So many robots, on a medium of `rate` [bit/s]."""

    robots: int
    rate: float

    @property
    def title(self) -> str:
        """Name it for a reader."""
        return f"{self.robots} robots, {self.rate / 1e6:g} Mbit/s"

    @property
    def episodes_end(self) -> float:
        """When the screens are photographed [s]."""
        return moment(schedule(SEED, self.robots, SECONDS), SECONDS)

    @property
    def ways(self) -> tuple[str, ...]:
        """How it is flown: frames are dropped at random where a quarter of what is offered fits."""
        return WAYS if self.rate == EACH * self.robots / 4 else tuple(way for way in WAYS if way != RANDOM)

    def folder(self, store: Path, way: str) -> Path:
        """Return where the run of one way is kept."""
        return store / f"{self.robots}-robots-{self.rate:.0f}" / way


MISSIONS = (
    Mission(8, 6e6),
    Mission(4, 3e6),
    Mission(2, 1.5e6),
    Mission(8, 3e6),
    Mission(8, 12e6),
)
"""A quarter of what is offered first, then an eighth and a half of it."""


@dataclass(frozen=True, slots=True)
class Flight:
    """A mission flown one way: what happened, and the folder of its screens.

    `busy` is how busy all cores of the machine were, from 0 to 1; `own` how many cores the mission's processes took.
    """

    mission: Mission
    way: str
    events: tuple[Event, ...]
    busy: float
    own: float
    photographs: Path


def fly(store: Path, missions: Sequence[Mission], most: float, tell: Callable[[str], None]) -> bool:
    """Fly what is not kept yet, for about `most` seconds; return whether all is kept."""
    deadline = time.monotonic() + most
    for mission in missions:
        for way in mission.ways:
            folder = mission.folder(store, way)
            if (folder / "events").exists():
                continue
            if time.monotonic() > deadline:
                return False
            tell(f"{mission.title}, {way}")
            _fly(mission, way, folder, store)
    return True


def kept(store: Path, missions: Sequence[Mission]) -> Iterator[Flight]:
    """Yield what was flown."""
    for mission in missions:
        for way in WAYS:
            folder = mission.folder(store, way)
            if (folder / "events").exists():
                busy, own = json.loads((folder / "busy.json").read_text())
                yield Flight(mission, way, tuple(read_events(folder / "events")), busy, own, folder)


def _fly(mission: Mission, way: str, folder: Path, store: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for stale in folder.iterdir():
        stale.unlink()
    conditions = Conditions(mission.robots, SECONDS, mission.rate, SEED, mission.episodes_end)
    first = mission.folder(store, WITHOUT) / "events"
    before = [event for event in read_events(first) if isinstance(event, Publish)] if first.exists() else []
    looks: list[tuple[float, float, float, float]] = []
    events = run_phase(way, conditions, folder, lambda _: looks.append(_processor()), before)
    worked, possible, own, passed = (later - sooner for sooner, later in zip(looks[0], looks[-1], strict=True))
    (folder / "busy.json").write_text(json.dumps([worked / max(possible, 1.0), own / max(passed, 0.01)]))
    write_events(folder / "new", events)
    (folder / "new").rename(folder / "events")


def _processor() -> tuple[float, float, float, float]:
    """Return how long all cores worked so far, and could have [ticks]; how long our processes did, and the time [s]."""
    ticks = [int(each) for each in Path("/proc/stat").read_text().splitlines()[0].split()[1:9]]
    worked = sum(ticks) - ticks[3] - ticks[4]
    return float(worked), float(sum(ticks)), sum(map(processor_time, _children(os.getpid()))), time.monotonic()


def processor_time(pid: int) -> float:
    """Return how long a process worked so far [s]; 0 for one that is gone."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except (FileNotFoundError, ProcessLookupError):
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _children(pid: int) -> list[int]:
    """Return the processes that a process has started."""
    found = [task.read_text() for task in Path(f"/proc/{pid}/task").glob("*/children")]
    return [int(child) for children in found for child in children.split()]
