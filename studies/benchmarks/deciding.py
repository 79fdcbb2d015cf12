"""How long decisions of a real daemon take, from the event that asks for one to its answer."""

import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from planner import Video
from proxy.core.interface.events import DecisionReady
from proxy.recording.entries import Happened
from proxy.recording.reading import RecordingReader
from studies.benchmarks.report import Table
from studies.benchmarks.traffic.agenda import draw
from studies.benchmarks.traffic.flight import Flight, fly
from studies.simulation.traffic.kinds import Kind
from studies.simulation.traffic.workloads import Workload, random

HORIZON = 60
"""Contested messages that a decision looks at."""
ROBOTS = 10
STREAMS, RATE, SIZE = 100, 30.0, 2_000
"""Of the robot that has many: how many, their rate [Hz], each or together, and their samples' size [B]."""
DEADLINE, SHORT = 0.02, 0.005
"""The usual deadline, and a shorter one [s]."""
BUSY = ("-c", "while True: pass")


@dataclass(frozen=True, slots=True)
class Case:
    """A team, the `deadline` of its decisions [s], and how many busy processes there are beside its daemons."""

    title: str
    workload: Workload
    deadline: float
    busy: int = 0


def many(streams: int, rate: float) -> Workload:
    """One robot with so many streams of this rate [Hz], of which a quarter fits."""
    kinds = tuple(Kind(f"stream-{n:03}", Video(1 / 30, 10.0), (rate, rate), (SIZE, SIZE)) for n in range(streams))
    return Workload("many", (kinds,), 0.25 * streams * rate * SIZE, 0.5)


def cases(*, quick: bool) -> tuple[Case, ...]:
    """Return what is measured; `quick` takes less of it, and small teams."""
    streams = 10 if quick else STREAMS
    slow, fast = many(streams, RATE / streams), many(streams, RATE)
    few = random(2 if quick else ROBOTS)
    found = (
        Case(f"{len(few.robots)} robots, *random*", few, DEADLINE),
        Case(f"{streams} streams, {RATE:g} Hz together, a busy process beside", slow, SHORT, 1),
        Case(f"{streams} streams, {RATE:g} Hz together", slow, SHORT),
        Case(f"{streams} streams, {RATE:g} Hz each", fast, SHORT),
        Case(f"{streams} streams, {RATE:g} Hz each, a busy process beside", fast, SHORT, 1),
    )
    return found[:2] if quick else found


def measure_deciding(*, quick: bool) -> list[Table]:
    """Fly all cases; `quick` takes some seconds, and tells little."""
    seconds = 4.0 if quick else 30.0
    rows = tuple(_row(case, *_flown(case, seconds)) for case in cases(quick=quick))
    note = (
        f"By the recording of the first robot's daemon, flights of {seconds:g} s, horizon {HORIZON}: from the event"
        " that asks for a decision to its answer, the window and its tables included. Samples whose answer prices"
        " prove need no search and are not counted. All daemons, applications and links share this machine's cores."
        " A quarter of what the streams send fits, of *random* 1 Mbit/s."
    )
    columns = ("team", "samples/s", "searched", "p50 [ms]", "p99 [ms]", "deadline [ms]", "over it", "over twice")
    return [Table("From the event to the answer", columns, rows, note)]


def _row(case: Case, took: Sequence[float], flight: Flight) -> tuple[str, ...]:
    """Return the cells of a case, whose searched decisions took so long [s]."""
    times = np.asarray(took)
    offered = sum(robot == 0 for robot, _, _ in flight.published) / flight.seconds
    return (
        case.title,
        f"{offered:.0f}",
        str(len(times)),
        *(f"{1e3 * np.quantile(times, q):.2f}" for q in (0.5, 0.99)),
        f"{1e3 * case.deadline:.0f}",
        *(f"{np.mean(times > n * case.deadline):.1%}" for n in (1, 2)),
    )


def _flown(case: Case, seconds: float) -> tuple[list[float], Flight]:
    """Fly a case; return how long the decisions of the first robot took [s], and the flight."""
    with TemporaryDirectory(prefix="sendworthy-deciding-") as name, _busy(case.busy):
        flags = (
            "--planner.horizon",
            str(HORIZON),
            "--planner.deadline",
            str(case.deadline),
            "--record.folder",
            name,
            "--record.on",
            "true",
        )
        flight = fly(draw(case.workload, seconds, 1), case.workload.spec(), flags=flags)
        return list(_durations(Path(name))), flight


def _durations(folder: Path) -> Iterator[float]:
    """Yield how long each searched decision took that the first robot's daemon recorded [s]."""
    for file in sorted(folder.glob("r1-*.mcap")):
        for entry in RecordingReader(file):
            plan = entry.event.plan if isinstance(entry, Happened) and isinstance(entry.event, DecisionReady) else None
            if plan is not None and plan.seconds is not None:
                yield plan.seconds


@contextmanager
def _busy(count: int) -> Iterator[None]:
    """Keep so many processes busy meanwhile."""
    busy = [subprocess.Popen([sys.executable, *BUSY]) for _ in range(count)]
    try:
        yield
    finally:
        for each in busy:
            each.kill()
            each.wait()
