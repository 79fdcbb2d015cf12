"""Policies that do not plan, to be beaten: a fixed part for each robot, and greedy sending with a reserve.

Both let the newest sample of each stream wait a moment until it fits (of alarms every one, for good), small types
first, then the stream that has waited longest. They know which types are small, and they tell each other nothing.
Where a part is less than a message, `static` sends by turns, for which its robots know the time; greedy senders save up
for it, and exceed the limit where several have done so.
"""

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import partial
from itertools import takewhile
from typing import NamedTuple

import numpy as np

from planner.problem import MARKOVIAN
from studies.simulation.agenda import Agenda
from studies.simulation.medium import Medium
from studies.simulation.records import Delivery, OnAir
from studies.simulation.traffic.flights import How
from studies.simulation.traffic.missions import Mission

LARGE = 0.95
"""A part is large enough that holds this part of what is not small."""
SPARE = 1.5
"""Where large messages go by turns, small types have so many times what they use by the mean."""
LATER = 1e-6
"""Turns are a little farther apart than they need be [s]: windows are closed."""
PATIENCE = 0.1
"""What is not small waits so long at most, but where it waits for a turn [s]: what was sent late is worth less."""
PACE = 0.002
"""While something waits, senders look this often whether it fits [s]."""


class Sent(NamedTuple):
    """So many bytes sent at `t` [s]; `beside`: small samples have their part beside it."""

    t: float
    size: float
    small: bool
    beside: bool


@dataclass(slots=True)
class Sender:
    """Decides for some streams within a part of the limit: `room` bytes in each closed `window` [s].

    With `reserve` what is not small leaves as much room as small types used in the last window, and what is larger than
    the part is checked against a window that is longer by as much, in which only what is not small counts. Where
    messages go by turns all that are not small have `turn` bytes now, and nothing of the part.
    """

    room: float
    window: float
    reserve: bool
    waiting: list[int] = field(default_factory=list)
    looks: bool = False
    turn: float | None = None
    _sent: deque[Sent] = field(default_factory=lambda: deque(maxlen=2000))
    _turn: dict[int, float] = field(default_factory=dict)

    def take(self, t: float, mission: Mission) -> list[int]:
        """Return what of the waiting is sent now, in order [indices]."""
        if self.turn is None:
            self.waiting = [i for i in self.waiting if i in mission.small or t < mission.frames[i].t_gen + PATIENCE]
        since = list(takewhile(lambda sent: sent.t >= t - self.window, self._sent))
        taken = []
        for index in sorted(self.waiting, key=lambda i: self._order(i, mission)):
            size, small = mission.frames[index].size, index in mission.small
            if self._may(t, size, since, small=small):
                beside = not small and (self.turn is not None or size > self.room)
                since.append(Sent(t, size, small, beside))
                self._sent.appendleft(since[-1])
                self._turn[mission.problem.messages[index].stream] = t
                self.waiting.remove(index)
                taken.append(index)
        return taken

    def _may(self, t: float, size: float, since: list[Sent], *, small: bool) -> bool:
        """Whether a sample may be sent now."""
        if self.turn is not None and not small:
            taking = size <= self.turn
            self.turn -= size if taking else 0.0
            return taking
        saves_up = self.reserve and size > self.room
        return self._rested(t, size, since) if saves_up else self._fits(size, since, small=small)

    def _order(self, index: int, mission: Mission) -> tuple[bool, float, int]:
        return index not in mission.small, self._turn.get(mission.problem.messages[index].stream, 0.0), index

    def _kept(self, since: Iterable[Sent]) -> float:
        """What is left free for small samples to come [B]."""
        return sum(sent.size for sent in since if sent.small) if self.reserve else 0.0

    def _fits(self, size: float, since: list[Sent], *, small: bool) -> bool:
        """Whether a sample has room beside what the window holds."""
        used = sum(sent.size for sent in since if not (small and sent.beside))
        return used + size + (0.0 if small else self._kept(since)) <= self.room

    def _rested(self, t: float, size: float, since: list[Sent]) -> bool:
        """Whether nothing but small samples was sent for as long as a sample that is too large needs by its rate."""
        left = self.room - sum(sent.size for sent in since if sent.small)
        last = next((sent.t for sent in self._sent if not sent.small), -float("inf"))
        return left > 0.0 and last < t - self.window * size / left


def _large(mission: Mission) -> float:
    """Return the size that most messages which are not small do not exceed [B]."""
    return float(np.quantile([f.size for i, f in enumerate(mission.frames) if i not in mission.small], LARGE))


def _small_use(mission: Mission) -> float:
    """Return what small types use by the mean in a window [B]."""
    return sum(mission.frames[i].size for i in mission.small) * mission.window / mission.problem.t_end


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
    _senders: dict[str, Sender] = field(init=False)
    _medium: Medium = field(init=False)

    def __post_init__(self) -> None:
        self._medium = Medium(self.how.rate, self.how.latency, self.how.loss, seed=self.seed)
        robots, limit, window = self.mission.robots, self.mission.carried, self.mission.window
        one = Sender(limit, window, self.reserve)
        parts = {robot: Sender(limit / len(robots), window, self.reserve) for robot in robots}
        self._senders = parts if self.apart else dict.fromkeys(robots, one)
        if self.apart and not self.reserve and _large(self.mission) > limit / len(robots):
            self._take_turns()

    def fly(self) -> "Simple":
        """Let all samples be published, and what fits be sent; return the flight."""
        for index, frame in enumerate(self.mission.frames):
            self._agenda.at(frame.t_gen, partial(self._publish, index))
        self._agenda.run(self.mission.problem.t_end)
        return self

    def _take_turns(self) -> None:
        """Give small types what they need, and the rest to one robot after the other, at one moment each."""
        mission, senders = self.mission, list(self._senders.values())
        small = SPARE * _small_use(mission) / len(senders)
        left = mission.carried - small * len(senders)
        at_once = max(1, int(left / _large(mission)))
        pace = mission.window / at_once + LATER
        for number, sender in enumerate(senders):
            sender.room, sender.turn = small, 0.0
            for turn in range(number, int(mission.problem.t_end / pace) + 1, len(senders)):
                self._agenda.at(turn * pace, partial(self._turn, sender, left / at_once))

    def _turn(self, sender: Sender, room: float, t: float) -> None:
        sender.turn = room
        self._send(sender, t)
        sender.turn = 0.0

    def _publish(self, index: int, t: float) -> None:
        problem, sender = self.mission.problem, self._senders[self.mission.frames[index].robot]
        stream = problem.messages[index].stream
        if problem.streams[stream].aggregation in MARKOVIAN:
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
