"""What decisions add to the delay of a frame: from its publication to its first byte on the medium, and to its arrival.

One robot and the operator, on a medium that is fast, so that nothing waits there; the spec's limit is half of what the
camera offers, so that every frame is decided. Now and then a frame waits for room under the limit: that is told apart,
as the robot's recording tells it.
"""

import json
import math
import tempfile
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from proxy.core.interface.events import DecisionReady, SamplePublished
from proxy.recording.entries import Entry, Gap, Happened
from proxy.recording.errors import RecordingError
from proxy.recording.reading import RecordingReader
from studies.demo.air import Air
from studies.demo.events import Publish, Receive, Serve, read_events
from studies.demo.figures import LARGE
from studies.demo.layout import OPERATOR, lay_out
from studies.demo.nodes import SURVEILLANCE, start_daemons, start_routers, status
from studies.demo.phase import LEAD
from studies.demo.processes import Troupe
from studies.demo.staging import PATIENCE, Cast, start_app, start_medium, start_robots
from studies.surveillance.cores import CoresError, held_to

MEDIUM = 100e6
"""What the medium carries [bit/s]."""
LIMIT = 1.5e6
"""What the spec allows [bit/s]."""
WINDOW = 0.95
TENTH = 0.1


@dataclass(frozen=True, slots=True)
class Way:
    """How a robot sends: by a stock router, or by our daemon in a mode and with so many iterations of the search."""

    title: str
    mode: str | None = None
    iterations: int | None = None
    part: float = 1.0
    """Of a core, for the robot's and the operator's daemon each."""


WAYS = (
    Way("stock routers"),
    Way("daemon, all pass", "pass"),
    Way("daemon that decides, as it comes", "enforce"),
    Way("daemon that decides, 300 iterations", "enforce", 300),
    Way("daemon, all pass, a tenth of a core", "pass", part=TENTH),
    Way("daemon that decides, as it comes, a tenth of a core", "enforce", part=TENTH),
    Way("daemon that decides, 300 iterations, a tenth of a core", "enforce", 300, TENTH),
)


@dataclass(frozen=True, slots=True)
class Delay:
    """Of one way: how many frames came and how long they took [s], and what the daemon says of its decisions.

    `waited` of them did so for room under the limit, the times are those of the others: `sent` to the first byte on the
    medium, p50 and p99. `decided` counts frames by search, `seconds` is how long one took on average and `longest` at
    most.
    """

    way: str
    frames: int
    waited: int
    sent: tuple[float, float]
    arrived: tuple[float, float]
    decided: int
    seconds: float
    longest: float


def measure(store: Path, seconds: float, most: float) -> list[Delay]:
    """Measure all ways that are not kept in `store` yet, for about `most` seconds; return all that are."""
    deadline = time.monotonic() + most
    file = store / "delays.json"
    found = json.loads(file.read_text()) if file.exists() else {}
    for way in WAYS:
        if way.title in found or time.monotonic() > deadline:
            continue
        try:
            found[way.title] = asdict(_measure(way, seconds))
        except CoresError:
            continue
        store.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(found, indent=2))
    return [
        Delay(**{**each, "sent": tuple(each["sent"]), "arrived": tuple(each["arrived"])}) for each in found.values()
    ]


def _measure(way: Way, seconds: float) -> Delay:
    nodes = lay_out(1)
    with tempfile.TemporaryDirectory(prefix="sendworthy-delays-") as name:
        folder = Path(name)
        with ExitStack() as stack:
            troupe = stack.enter_context(Troupe(folder))
            _, dials = start_medium(troupe, nodes, Air(MEDIUM / 8), folder / "medium.jsonl")
            if way.mode is None:
                start_routers(troupe, nodes, dials)
            else:
                spec = SURVEILLANCE.format(limit=LIMIT, window=WINDOW)
                flags = [] if way.iterations is None else ["--planner.iterations", str(way.iterations)]
                own = {nodes[1].name: ["--record.on", "true", "--record.folder", name]}
                daemons = start_daemons(troupe, nodes, dials, spec, folder, mode=way.mode, flags=flags, own_flags=own)
                if way.part < 1.0:
                    stack.enter_context(held_to(way.part, [daemon.pid for daemon in daemons]))
            operator = start_app(
                troupe, "operator", nodes[0], folder, ["--photograph-at", "1e9", "--photographs", name]
            )
            apps = [*start_robots(troupe, nodes, Cast(1, seconds, 1), folder).all, operator]
            operator.hear(PATIENCE)
            start = time.monotonic() + LEAD
            for app in apps:
                app.tell(start)
            time.sleep(max(0.0, start + seconds - time.monotonic()))
            troupe.check()
            decisions = {} if way.mode is None else status(nodes[1])["decisions"]
        return _delay(way.title, folder, decisions)


def _delay(title: str, folder: Path, decisions: dict[str, float]) -> Delay:
    events = [event for path in folder.glob("*.jsonl") for event in read_events(path, "with")]
    published = {event.number: event.t for event in events if isinstance(event, Publish)}
    received = [event for event in events if isinstance(event, Receive)]
    first = np.sort([e.t for e in events if isinstance(e, Serve) and e.sink == OPERATOR and e.size >= LARGE])
    held = {number for path in folder.glob("*.mcap") for number in waited(RecordingReader(path))}
    sent, arrived = [], []
    for event in received:
        if event.number in held:
            continue
        begun = published[event.number]
        place = int(np.searchsorted(first, begun))
        if place < len(first) and first[place] <= event.t:
            sent.append(first[place] - begun)
        arrived.append(event.t - begun)
    made = int(decisions.get("made", 0))
    mean = decisions.get("seconds", 0.0) / made if made else 0.0
    longest = decisions.get("longest", 0.0)
    return Delay(title, len(received), len(received) - len(arrived), _ends(sent), _ends(arrived), made, mean, longest)


def waited(recording: Iterable[Entry]) -> Iterator[int]:
    """Yield the numbers of a camera's frames that were decided later than they came, as they waited for room.

    Raises RecordingError for a recording with a gap.
    """
    came: dict[int, tuple[int, float]] = {}
    asked, frames = -math.inf, 0
    for entry in recording:
        if isinstance(entry, Gap):
            raise RecordingError(f"{entry.events} events are missing")
        if not isinstance(entry, Happened):
            continue
        event = entry.event
        if isinstance(event, SamplePublished) and event.key.endswith("/camera"):
            frames += 1 + event.superseded
            came[event.sample] = frames - 1, event.now
        for command in entry.commands:
            if command["command"] == "Decide":
                asked = command["asked"]
            elif command["command"] == "Forward" and command["sample"] in came:
                number, at = came[command["sample"]]
                if isinstance(event, DecisionReady) and asked > at:
                    yield number


def _ends(values: Sequence[float]) -> tuple[float, float]:
    """Return the median and the 99th percentile."""
    if not values:
        return float("nan"), float("nan")
    return float(np.percentile(values, 50)), float(np.percentile(values, 99))
