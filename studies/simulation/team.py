"""A team of cores on one medium: a discrete-event simulation in which every robot runs the daemon's core."""

import heapq
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from planner import Plan, SearchSettings, start
from proxy.core import events as ev
from proxy.core.codec import pack_digest
from proxy.core.commands import Command, Decide, Drop, Forward, SendDigest, SendState
from proxy.core.core import Core
from proxy.core.settings import CoreSettings
from proxy.core.view import intersects
from proxy.core.wire import Digest, State
from studies.simulation.medium import Medium
from utility_specs import Specs

DIGEST_OVERHEAD = 24
"""Bytes around a digest on the wire."""
STATE_LATENCY = 0.02
"""States go over a reliable channel and arrive after this time [s]."""


@dataclass(frozen=True, slots=True)
class Frame:
    """A sample that an app will publish: `t_gen` is true time [s], `size` in bytes."""

    robot: str
    key: str
    t_gen: float
    size: int
    features: dict[str, float]


@dataclass(frozen=True, slots=True)
class Delivery:
    """A frame that was sent, and when it arrived (None: lost)."""

    frame: Frame
    t_sent: float
    t_rcv: float | None


@dataclass
class Team:
    """Robots by name, each with its subscriptions; `clocks` are added to true time by each robot."""

    specs: Specs
    interests: dict[str, tuple[str, ...]]
    medium: Medium
    seed: int = 0
    iterations: int = 300
    decision_time: float = 0.003
    clocks: dict[str, float] = field(default_factory=dict)
    settings: CoreSettings = field(default_factory=lambda: CoreSettings("", ""))
    search: SearchSettings = field(default_factory=SearchSettings)
    deliveries: list[Delivery] = field(default_factory=list)
    digest_bytes: int = 0

    def __post_init__(self) -> None:
        self._rng = np.random.default_rng(self.seed)
        self._events: list[tuple[float, int, Callable[[float], None]]] = []
        self._order = 0
        self._frames: dict[str, dict[int, Frame]] = {robot: {} for robot in self.interests}
        self.cores = {
            robot: Core(
                replace(self.settings, robot=robot, zid=f"z-{robot}", iterations=self.iterations),
                self.specs,
                self._clock(robot, 0.0),
            )
            for robot in self.interests
        }
        self._wakes = dict.fromkeys(self.interests, -1.0)

    def run(self, frames: Sequence[Frame], until: float) -> list[Delivery]:
        """Let the apps publish `frames` and return everything that was sent by `until` [s]."""
        for robot, keys in self.interests.items():
            self._at(0.0, partial(self._subscribe, robot, keys))
            for other in self.interests:
                if other != robot:
                    self._at(0.01, partial(self._meet, robot, other))
        for number, frame in enumerate(frames):
            self._at(frame.t_gen, partial(self._publish, number, frame))
        while self._events and self._events[0][0] <= until:
            t, _, action = heapq.heappop(self._events)
            action(t)
        return self.deliveries

    def _subscribe(self, robot: str, keys: tuple[str, ...], t: float) -> None:
        self._feed(robot, t, ev.InterestChanged(self._clock(robot, t), keys))

    def _meet(self, robot: str, other: str, t: float) -> None:
        self._feed(robot, t, ev.PeerAppeared(self._clock(robot, t), other, f"z-{other}"))

    def _publish(self, number: int, frame: Frame, t: float) -> None:
        now = self._clock(frame.robot, t)
        self._frames[frame.robot][number] = frame
        event = ev.SamplePublished(now, number, frame.key, frame.size, now, None, 5, frame.features)
        self._feed(frame.robot, t, event)

    def _feed(self, robot: str, t: float, event: ev.Event) -> None:
        for command in self.cores[robot].handle(event):
            self._execute(robot, t, command)
        wake = self.cores[robot].wake_at(self._clock(robot, t)) - self.clocks.get(robot, 0.0)
        if self._wakes[robot] <= t or wake < self._wakes[robot]:
            self._wakes[robot] = max(wake, t + 1e-4)
            self._at(self._wakes[robot], partial(self._wake, robot))

    def _wake(self, robot: str, t: float) -> None:
        if t >= self._wakes[robot]:
            self._feed(robot, t, ev.TimePassed(self._clock(robot, t)))

    def _execute(self, robot: str, t: float, command: Command) -> None:
        match command:
            case Decide():
                search = start(command.problem, self.search, command.seed)
                search.run(command.iterations)
                self._at(t + self.decision_time, partial(self._decided, robot, command.ticket, search.plan()))
            case Forward(sample):
                self._transmit(robot, t, self._frames[robot].pop(sample))
                self._at(t, partial(self._handed, robot, sample))
            case Drop(sample):
                del self._frames[robot][sample]
            case SendDigest(digest):
                size = len(pack_digest(digest)) + DIGEST_OVERHEAD
                for other in (o for o in self.interests if o != robot):
                    self.digest_bytes += size
                    arrival = self.medium.offer(t, size, self._rng)
                    if arrival is not None:
                        self._at(arrival, partial(self._hear_digest, other, digest))
            case SendState(state):
                for other in (o for o in self.interests if o != robot):
                    self._at(t + STATE_LATENCY, partial(self._hear_state, other, state))

    def _decided(self, robot: str, ticket: int, plan: Plan, t: float) -> None:
        self._feed(robot, t, ev.DecisionReady(self._clock(robot, t), ticket, plan))

    def _handed(self, robot: str, sample: int, t: float) -> None:
        self._feed(robot, t, ev.SampleHanded(self._clock(robot, t), sample))

    def _hear_digest(self, robot: str, digest: Digest, t: float) -> None:
        self._feed(robot, t, ev.DigestHeard(self._clock(robot, t), digest))

    def _hear_state(self, robot: str, state: State, t: float) -> None:
        self._feed(robot, t, ev.StateHeard(self._clock(robot, t), state))

    def _transmit(self, robot: str, t: float, frame: Frame) -> None:
        stamp = self._clock(robot, frame.t_gen)
        for other, keys in self.interests.items():
            if other != robot and any(intersects(key, frame.key) for key in keys):
                arrival = self.medium.offer(t, frame.size, self._rng)
                self.deliveries.append(Delivery(frame, t, arrival))
                if arrival is not None:
                    self._at(arrival, partial(self._hear, other, frame, stamp))

    def _hear(self, robot: str, frame: Frame, stamp: float, t: float) -> None:
        origin = f"z-{frame.robot}"
        event = ev.SampleHeard(self._clock(robot, t), frame.key, frame.size, origin, stamp, None)
        self._feed(robot, t, event)

    def _clock(self, robot: str, t: float) -> float:
        return t + 1000.0 + self.clocks.get(robot, 0.0)

    def _at(self, t: float, action: Callable[[float], None]) -> None:
        self._order += 1
        heapq.heappush(self._events, (t, self._order, action))
