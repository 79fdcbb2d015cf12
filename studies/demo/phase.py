"""One run of the demo: the same robots, world and medium, with the filter, without it, downsampled, or at random."""

import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from studies.demo import links
from studies.demo.air import Air
from studies.demo.events import EVERYONE, Event, Links, Publish, Receive, Run, Serve, read_events
from studies.demo.footage import Footage
from studies.demo.layout import OPERATOR, Node, lay_out
from studies.demo.namespaces import Namespaces
from studies.demo.nodes import (
    DOWNSAMPLED,
    RANDOM,
    SHARE,
    SURVEILLANCE,
    WINDOW,
    WITH,
    count,
    start_daemons,
    start_routers,
)
from studies.demo.processes import Process, Troupe
from studies.demo.scene import PERIOD
from studies.demo.staging import MEDIUM, PATIENCE, Apps, Cast, start_app, start_medium, start_robots

LEAD = 0.3
"""The apps are told the start time this long ahead [s]."""
CARRIED = 0.95
"""Downsampled cameras may fill this part of the medium: what is around frames needs the rest."""


@dataclass(frozen=True, slots=True)
class Conditions:
    """`seconds` of run on a medium of `rate` [bit/s]; the screen is photographed at `photograph_at` [s].

    `latency` [s] and `loss` are the medium's too. Robots replay their `footage`, if there is any. With `netns` the
    medium is one of the kernel's, which needs root.
    """

    robots: int
    seconds: float
    rate: float
    seed: int
    photograph_at: float
    latency: float = 0.0
    loss: float = 0.0
    footage: tuple[Footage, ...] = ()
    netns: bool = False

    @property
    def air(self) -> Air:
        """The medium."""
        return Air(self.rate / 8, self.latency, self.loss)


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
    with ExitStack() as stack:
        nodes = lay_out(conditions.robots)
        channel = stack.enter_context(Namespaces(conditions.air)) if conditions.netns else None
        troupe = stack.enter_context(Troupe(folder))
        if channel:
            nodes = channel.add(nodes)
            dials = channel.dials(nodes)
        else:
            _, dials = start_medium(troupe, nodes, conditions.air, folder / "medium.jsonl")
        limit = SHARE * conditions.rate
        if phase == WITH:
            spec = SURVEILLANCE.format(limit=limit, window=WINDOW)
            stations = start_daemons(troupe, nodes, dials, spec, folder)
        else:
            frequency = _tuned(before, conditions.rate) if phase == DOWNSAMPLED else None
            stations = start_routers(troupe, nodes, dials, frequency)
        keep = min(1.0, _tuned(before, conditions.rate) * PERIOD) if phase == RANDOM else 1.0
        apps = _start_apps(troupe, nodes, conditions, folder, keep)
        watch = _Watch(phase, troupe, stations, apps, channel)
        start = time.monotonic() + LEAD
        for app in apps.all:
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


def _start_apps(troupe: Troupe, nodes: tuple[Node, ...], conditions: Conditions, folder: Path, keep: float) -> Apps:
    """Start the robots' apps and the operator's; return when all are ready."""
    screen = ["--photograph-at", str(conditions.photograph_at), "--photographs", str(folder)]
    operator = start_app(troupe, "operator", nodes[0], folder, screen)
    cast = Cast(conditions.robots, conditions.seconds, conditions.seed, conditions.footage, keep)
    apps = start_robots(troupe, nodes, cast, folder)
    operator.hear(PATIENCE)
    apps.others.append(operator)
    apps.owners[operator.name] = 0
    return apps


class _Watch:
    """Watches a run: its progress, its processes, and that nothing goes around the medium."""

    def __init__(
        self,
        phase: str,
        troupe: Troupe,
        stations: list[Process],
        apps: Apps,
        channel: Namespaces | None,
    ) -> None:
        self._phase = phase
        self._troupe = troupe
        self._owners = {process.pid: process.name for process in troupe.processes}
        self._channel = channel
        self._carried = channel.carried() if channel else 0
        self._allowed = [(app, stations[number].name) for app, number in apps.owners.items()]

    def until(self, start: float, seconds: float, folder: Path, tell: Callable[[Progress], None]) -> list[Event]:
        """Watch until the run is over; return what was seen of the connections."""
        looks: list[Event] = []
        log = folder / f"operator-{OPERATOR}.jsonl"
        while (left := start + seconds - time.monotonic()) > 0:
            time.sleep(min(left, 1.0))
            self._troupe.check()
            now = time.monotonic()
            looks.append(self._look(now))
            received = list(read_events(log, self._phase))
            last = received[-1] if received else None
            age = last.t - last.t_gen if isinstance(last, Receive) else 0.0
            tell(Progress(self._phase, seconds, now - start, len(received), age))
        return looks

    def _look(self, now: float) -> Event:
        """Look at the connections; where the kernel keeps robots apart, at what it carried instead."""
        if self._channel:
            before, self._carried = self._carried, self._channel.carried()
            return Serve(self._phase, now, EVERYONE, EVERYONE, self._carried - before)
        found = links.connections(self._owners)
        direct = links.around(found, MEDIUM, self._allowed)
        return Links(self._phase, now, sum(MEDIUM in pair for pair in found), len(direct))
