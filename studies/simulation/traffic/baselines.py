"""Policies that do not plan, to be beaten: a fixed part for each robot, and greedy sending with a reserve.

Both let the newest sample of each stream wait until it fits (of alarms every one), small types first, then the stream
that has waited longest for its turn. They know which types are small; they need no digests.
"""

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import partial
from itertools import takewhile
from typing import NamedTuple

from planner import Aggregation
from studies.simulation.agenda import Agenda
from studies.simulation.medium import Medium
from studies.simulation.records import Delivery, OnAir
from studies.simulation.traffic.flights import How
from studies.simulation.traffic.missions import RATE, Mission

PACE = 0.002
"""While something waits, senders look this often whether it fits [s]."""


class Sent(NamedTuple):
    """So many bytes sent at `t` [s]; `stretched`: more than fits one window."""

    t: float
    size: float
    small: bool
    stretched: bool


@dataclass(slots=True)
class Sender:
    """Decides for some streams within a part of the limit: `room` bytes in each closed `window` [s].

    With `reserve` what is not small leaves as much room as small types used in the last window. What is larger than the
    part is checked against a window that is longer by as much, in which only what is not small counts.
    """

    room: float
    window: float
    reserve: bool
    waiting: list[int] = field(default_factory=list)
    looks: bool = False
    _sent: deque[Sent] = field(default_factory=lambda: deque(maxlen=2000))
    _turn: dict[int, float] = field(default_factory=dict)

    def take(self, t: float, mission: Mission) -> list[int]:
        """Return what of the waiting is sent now, in order [indices]."""
        taken = []
        for index in sorted(self.waiting, key=lambda i: self._order(i, mission)):
            size, small = mission.frames[index].size, index in mission.small
            since = list(takewhile(lambda sent: sent.t >= t - self.window, self._sent))
            stretched = size > self.room
            if self._rested(t, size, since) if stretched else self._fits(size, since, small=small):
                self._sent.appendleft(Sent(t, size, small, stretched))
                self._turn[mission.problem.messages[index].stream] = t
                self.waiting.remove(index)
                taken.append(index)
        return taken

    def _order(self, index: int, mission: Mission) -> tuple[bool, float, int]:
        return index not in mission.small, self._turn.get(mission.problem.messages[index].stream, 0.0), index

    def _kept(self, since: Iterable[Sent]) -> float:
        """What is left free for small samples to come [B]."""
        return sum(sent.size for sent in since if sent.small) if self.reserve else 0.0

    def _fits(self, size: float, since: list[Sent], *, small: bool) -> bool:
        """Whether a sample has room beside what the window holds."""
        used = sum(sent.size for sent in since if not (small and sent.stretched))
        return used + size + (0.0 if small else self._kept(since)) <= self.room

    def _rested(self, t: float, size: float, since: list[Sent]) -> bool:
        """Whether nothing but small samples was sent for as long as a sample that is too large needs by its rate."""
        left = self.room - sum(sent.size for sent in since if sent.small)
        last = next((sent.t for sent in self._sent if not sent.small), -float("inf"))
        return left > 0.0 and last < t - self.window * size / left


@dataclass(slots=True)
class Simple:
    """A flight by senders that do not plan, scored like that of a team; `parts` are by robot, or one for all."""

    mission: Mission
    how: How
    seed: int
    apart: bool
    reserve: bool
    deliveries: list[Delivery] = field(default_factory=list)
    on_air: list[OnAir] = field(default_factory=list)
    _agenda: Agenda = field(default_factory=Agenda)
    _senders: dict[str, Sender] = field(default_factory=dict)
    _medium: Medium = field(init=False)

    def __post_init__(self) -> None:
        self._medium = Medium(RATE, self.how.latency, self.how.loss, seed=self.seed)
        robots, limit = self.mission.robots, self.mission.carried
        one = Sender(limit, self.mission.window, self.reserve)
        for robot in robots:
            part = Sender(limit / len(robots), self.mission.window, self.reserve)
            self._senders[robot] = part if self.apart else one

    def fly(self) -> "Simple":
        """Let all samples be published, and what fits be sent; return the flight."""
        for index, frame in enumerate(self.mission.frames):
            self._agenda.at(frame.t_gen, partial(self._publish, index))
        self._agenda.run(self.mission.problem.t_end)
        return self

    def _publish(self, index: int, t: float) -> None:
        problem, sender = self.mission.problem, self._senders[self.mission.frames[index].robot]
        stream = problem.messages[index].stream
        if problem.streams[stream].aggregation is Aggregation.MOST_RECENT:
            sender.waiting = [i for i in sender.waiting if problem.messages[i].stream != stream]
        sender.waiting.append(index)
        self._send(sender, t)

    def _send(self, sender: Sender, t: float) -> None:
        for index in sender.take(t, self.mission):
            self._transmit(index, t)
        if sender.waiting and not sender.looks:
            sender.looks = True
            self._agenda.at(t + PACE, partial(self._look, sender))

    def _look(self, sender: Sender, t: float) -> None:
        sender.looks = False
        self._send(sender, t)

    def _transmit(self, index: int, t: float) -> None:
        frame, interests = self.mission.frames[index], self.mission.interests
        wanting = [robot for robot, keys in interests.items() if keys and robot != frame.robot]
        send = self._medium.broadcast if self.how.broadcasts else self._medium.unicast
        arrivals = send(t, frame.size, frame.robot, wanting)
        self.on_air.append(OnAir(t, frame.robot, frame.size * (1 if self.how.broadcasts else len(wanting)), frame))
        self.deliveries += [Delivery(frame, t, min(times, default=None), to) for to, times in arrivals.items()]
