"""One run of the demo: the same robots, scene and medium, with the filter, without it, or with Zenoh's downsampling."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from studies.demo import links
from studies.demo.events import Event, Links, Publish, Receive, Run, read_events
from studies.demo.layout import OPERATOR, Node, lay_out, pairs
from studies.demo.nodes import DOWNSAMPLED, SHARE, SURVEILLANCE, WINDOW, WITH, count, start_daemons, start_routers
from studies.demo.processes import Process, Troupe

PATIENCE = 20.0
"""How long a process may take to get ready [s]."""
LEAD = 0.3
"""The apps are told the start time this long ahead [s]."""
CARRIED = 0.95
"""Downsampled cameras may fill this part of the medium: what is around frames needs the rest."""
MEDIUM = "medium"


@dataclass(frozen=True, slots=True)
class Conditions:
    """`seconds` of run on a medium of `rate` [bit/s]; the screen is photographed at `photograph_at` [s]."""

    robots: int
    seconds: float
    rate: float
    seed: int
    photograph_at: float


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a run of `seconds` is: seconds since the start, frames received, and the age of the last one [s]."""

    phase: str
    seconds: float
    elapsed: float
    frames: int
    age: float


def run_phase(
    phase: str, conditions: Conditions, folder: Path, tell: Callable[[Progress], None], before: Sequence[Event] = ()
) -> list[Event]:
    """Run once and return what happened; the frames on the screen, logs and configs are left in `folder`.

    `before` is what happened in earlier runs: it tells how often cameras may send that are downsampled.
    """
    nodes = lay_out(conditions.robots)
    with Troupe(folder) as troupe:
        dials = _start_medium(troupe, nodes, conditions.rate, folder)
        limit = SHARE * conditions.rate
        if phase == WITH:
            spec = SURVEILLANCE.format(limit=limit, window=WINDOW)
            stations = start_daemons(troupe, nodes, dials, spec, folder)
        else:
            frequency = _tuned(before, conditions.rate) if phase == DOWNSAMPLED else None
            stations = start_routers(troupe, nodes, dials, frequency)
        apps = _start_apps(troupe, nodes, conditions, folder)
        watch = _Watch(phase, troupe, stations, apps)
        start = time.monotonic() + LEAD
        for app in apps:
            app.tell(start)
        looks = watch.until(start, conditions.seconds, folder, tell)
        counts = count(phase, nodes) if phase == WITH else []
    robots = tuple(node.name for node in nodes[1:])
    run = Run(phase, start, conditions.seconds, robots, conditions.rate, limit, WINDOW)
    logs = [event for path in sorted(folder.glob("*.jsonl")) for event in read_events(path, phase)]
    return [run, *logs, *counts, *looks]


def _tuned(before: Sequence[Event], rate: float) -> float:
    """Return how often each camera may send so that the medium carries them all [1/s], by what they published.

    `rate` is the medium's [bit/s]. As frames come ten times a second, that is tuned better than to the spec's limit.
    """
    published = [event for event in before if isinstance(event, Publish)]
    a_frame_each = sum(event.size for event in published) / len(published) * len({event.robot for event in published})
    return CARRIED * rate / 8 / a_frame_each


def _start_medium(troupe: Troupe, nodes: tuple[Node, ...], rate: float, folder: Path) -> dict[str, list[str]]:
    """Start the medium; return which endpoints each node dials."""
    linked = list(pairs(nodes))
    command = ["-m", "studies.demo.relay", "--rate", str(rate), "--log", str(folder / "medium.jsonl")]
    for dialer, target in linked:
        command += ["--pair", f"{dialer.name},{target.name},{target.mesh_port}"]
    ports = troupe.start(MEDIUM, *command).hear(PATIENCE)["ports"]
    dials: dict[str, list[str]] = {node.name: [] for node in nodes}
    for (dialer, _), port in zip(linked, ports, strict=True):
        dials[dialer.name].append(f"tcp/127.0.0.1:{port}")
    return dials


def _start_apps(troupe: Troupe, nodes: tuple[Node, ...], conditions: Conditions, folder: Path) -> list[Process]:
    """Start the operator's app and the cameras, in the order of the nodes; return when all are ready."""
    screen = ["--photograph-at", str(conditions.photograph_at), "--photographs", str(folder)]
    apps = [_app(troupe, "operator", nodes[0], folder, screen)]
    for node in nodes[1:]:
        what = ["--robot", str(node.number - 1), "--robots", str(conditions.robots)]
        what += ["--seconds", str(conditions.seconds), "--seed", str(conditions.seed)]
        apps.append(_app(troupe, "camera", node, folder, what))
    for app in apps:
        app.hear(PATIENCE)
    return apps


def _app(troupe: Troupe, kind: str, node: Node, folder: Path, arguments: list[str]) -> Process:
    log = folder / f"{kind}-{node.name}.jsonl"
    command = ["-m", f"studies.demo.{kind}", "--connect", node.app_endpoint, "--log", str(log), *arguments]
    return troupe.start(f"{kind}-{node.name}", *command)


class _Watch:
    """Watches a run: its progress, its processes, and that nothing goes around the medium."""

    def __init__(
        self,
        phase: str,
        troupe: Troupe,
        stations: list[Process],
        apps: list[Process],
    ) -> None:
        self._phase = phase
        self._troupe = troupe
        self._owners = {process.pid: process.name for process in troupe.processes}
        self._allowed = [(app.name, station.name) for app, station in zip(apps, stations, strict=True)]

    def until(self, start: float, seconds: float, folder: Path, tell: Callable[[Progress], None]) -> list[Event]:
        """Watch until the run is over; return what was seen of the connections."""
        looks: list[Event] = []
        log = folder / f"operator-{OPERATOR}.jsonl"
        while (left := start + seconds - time.monotonic()) > 0:
            time.sleep(min(left, 1.0))
            self._troupe.check()
            now = time.monotonic()
            found = links.connections(self._owners)
            direct = links.around(found, MEDIUM, self._allowed)
            looks.append(Links(self._phase, now, sum(MEDIUM in pair for pair in found), len(direct)))
            received = list(read_events(log, self._phase))
            last = received[-1] if received else None
            age = last.t - last.t_gen if isinstance(last, Receive) else 0.0
            tell(Progress(self._phase, seconds, now - start, len(received), age))
        return looks
