"""What nobody could have exceeded: the offline optimum with fractions of samples, in pieces whose borders are free.

A piece knows all of its samples, and of those before it that whoever wants them may have got any of them without cost;
limits hold within a piece only. So all pieces together are worth at least as much as any plan. Samples may be sent a
little later than they are published: windows are shorter by what the replay let any of them wait, so that no plan is
forbidden that lets samples wait no longer.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from planner import Aggregation, Constraint, Message, MessageUtility, Problem, Step, Stream
from planner.definition import utility
from planner.utility import Floats, Ints
from studies.oracle import upper_bound
from studies.replay.errors import ReplayError
from studies.replay.mission import Limit, Mission
from studies.replay.outcomes import Columns, Outcomes
from studies.replay.pieces import Gains, in_pieces, undominated

MOST_CARRIED = 50
"""Samples of a stream that whoever wants them may have from before a piece; what others are worth is added."""
SHORT = 0.2
"""Part of a window that samples wait at most: where they wait longer, several windows are looked at as one."""
EVERY = 1e-3
"""The bound looks at windows that end so far apart [s]."""
SOON = 1e-3
"""What is so close to the end of a piece counts as received at once [s]."""
CONSTANT = Step(1.0, 1e6)
"""The utility of what does not depend on when it is received."""

Progress = Callable[[int, int], object]


@dataclass(frozen=True, slots=True)
class Bound:
    """At most so much could be gained [utility·s]: in each piece, and by each type if it had the limits to itself."""

    by_piece: Floats
    by_type: dict[str, float]

    @property
    def utility(self) -> float:
        """By all together."""
        return float(self.by_piece.sum())


@dataclass(frozen=True, slots=True)
class Aged:
    """The utility of a sample that was so old [s] when it was published, by its age since then."""

    utility: MessageUtility
    age: float

    def value(self, age: Floats) -> Floats:
        """u(a) for every age [1/s]."""
        return self.utility.value(age + self.age)

    def integral(self, start: Floats, end: Floats) -> Floats:
        """∫ u(a) da over [start, end] for every pair of ages [1]."""
        return self.utility.integral(start + self.age, end + self.age)


def bound(outcomes: Outcomes, columns: Columns, borders: Floats, progress: Progress) -> Bound:
    """Bound what could be gained, piece by piece, and tell how many of how many are done.

    Raises ReplayError for aggregations that cannot be cut into pieces, OracleUnavailable without SciPy.
    """
    covered = [stream for stream in outcomes.streams if stream.covering is not None]
    for stream in covered:
        if not isinstance(stream.aggregation, Aggregation):
            raise ReplayError(f'there is no bound: "{stream.type_name}" has an aggregation of its own')
    names = list(dict.fromkeys(stream.type_name for stream in covered))
    count = len(borders) - 1
    whole, alone = np.zeros(count), np.zeros((count, len(names)))
    for at, piece in enumerate(_Pieces(outcomes, columns, borders).all()):
        whole[at] = piece.most()
        alone[at] = [piece.most(name) for name in names] if len(names) > 1 else whole[at]
        progress(at + 1, count)
    return Bound(whole, dict(zip(names, alone.sum(axis=0).tolist(), strict=True)))


def relaxed(limit: Limit, wait: float, largest: float) -> Constraint:
    """Return what holds of samples by when they are published, where each is sent within `wait` [s] from then on.

    `largest` is the most that a sample uses of the limit. What is published within W − wait is sent within W. Of
    several windows as one the first may hold a sample that exceeds the limit.
    """
    window, most = limit.measure.window, limit.measure.limit
    windows = 1 if wait <= SHORT * window else math.ceil(wait / (SHORT * window))
    if windows == 1:
        return Constraint(limit.name, window - wait, most)
    return Constraint(limit.name, windows * window - wait, max(most, largest) + (windows - 1) * most)


@dataclass(frozen=True, slots=True)
class _Piece:
    """A piece of the traffic; `beside` is by stream what that may be worth which its messages leave out [utility·s]."""

    outcomes: Outcomes
    messages: tuple[Message, ...]
    constraints: tuple[Constraint, ...]
    beside: dict[int, float]
    begin: float
    end: float

    def most(self, name: str | None = None) -> float:
        """Return the most that all types can gain, or one alone [utility·s]."""
        streams = self.outcomes.streams
        messages = tuple(m for m in self.messages if name in (None, streams[m.stream].type_name))
        beside = sum(worth for at, worth in self.beside.items() if name in (None, streams[at].type_name))
        if not messages:
            return beside
        problem = self.problem(messages)
        everything_sent = all(m.sent for m in messages)
        return beside + (utility(problem, ()) if everything_sent else upper_bound(problem, EVERY).bound)

    def problem(self, messages: tuple[Message, ...]) -> Problem:
        """Return some of the messages as a problem."""
        return Problem(
            tuple(Stream(stream.robot, stream.aggregation) for stream in self.outcomes.streams),
            messages,
            next((i for i, m in enumerate(messages) if not m.sent), 0),
            self.constraints,
            (),
            t_start=self.begin,
            t_end=self.end,
            goes_on=False,
        )


class _Pieces:
    """Makes the pieces in turn: each begins with what may have been received before it."""

    def __init__(self, outcomes: Outcomes, columns: Columns, borders: Floats) -> None:
        self._outcomes, self._columns, self._borders = outcomes, columns, borders
        self._mission: Mission = outcomes.mission
        self._gains = Gains(outcomes, columns, borders)
        self._constraints = self._relaxed()
        self._free = (0.0,) * len(self._constraints)
        self._carried: dict[int, Ints] = {}
        """By stream the samples that may have been received before the next piece."""

    def all(self) -> Iterator[_Piece]:
        """Yield one piece after the other."""
        for begin, end, flags in in_pieces(self._borders, self._columns.t):
            here = np.flatnonzero(flags)
            beside: dict[int, float] = {}
            messages = [m for stream in self._carried for m in self._before(stream, begin, end, beside)]
            messages += [m for i in here.tolist() if (m := self._message(i, end)) is not None]
            messages.sort(key=lambda m: (m.t_gen, self._outcomes.streams[m.stream].robot, m.stream))
            yield _Piece(self._outcomes, tuple(messages), self._constraints, beside, begin, end)
            self._carry(here, end)

    def _relaxed(self) -> tuple[Constraint, ...]:
        columns, mission = self._columns, self._mission
        planned = np.array([stream.planned for stream in self._outcomes.streams], dtype=np.bool_)
        sent = columns.sent & planned[columns.stream]
        wait = float((columns.t_sent - columns.t)[sent].max(initial=0.0))
        sizes = {
            (int(s), self._outcomes.streams[int(k)].robot) for s, k in zip(columns.size, columns.stream, strict=True)
        }
        largest = np.max([mission.use(*each) for each in sizes], axis=0) if sizes else np.zeros(len(mission.limits))
        return tuple(relaxed(limit, wait, float(most)) for limit, most in zip(mission.limits, largest, strict=True))

    def _before(self, stream: int, begin: float, end: float, beside: dict[int, float]) -> Iterator[Message]:
        """Yield what of a stream may be there when a piece begins; of many the best, the others go to `beside`."""
        samples = self._carried[stream]
        arrival = np.maximum(self._columns.t[samples] + self._mission.latency, begin)
        worth = self._gains.worth(samples, arrival, np.full(len(samples), end))
        best = np.argsort(worth)[::-1]
        samples, worth = samples[best], worth[best]
        left = worth[MOST_CARRIED:]
        if len(left):
            several = self._outcomes.streams[stream].aggregation is Aggregation.BEST
            beside[stream] = float(left.sum() if several else left.max())
        for i in samples[:MOST_CARRIED].tolist():
            t = float(self._columns.t[i])
            yield self._made(i, max(t + self._mission.latency, begin), self._free)

    def _message(self, index: int, end: float) -> Message | None:
        """Return a sample of a piece; None for one that is worth nothing within it."""
        columns, stream = self._columns, self._outcomes.streams[int(self._columns.stream[index])]
        if stream.covering is None:
            return None
        use = self._mission.use(int(columns.size[index]), stream.robot) if stream.planned else self._free
        t_rcv = float(columns.t[index]) + self._mission.latency
        if stream.aggregation is Aggregation.SUM:
            return self._added(index, use, end)
        # What comes too late still is the newest there is.
        return self._made(index, t_rcv, use) if t_rcv < end or stream.aggregation is Aggregation.CURRENT else None

    def _made(self, index: int, t_rcv: float, use: tuple[float, ...]) -> Message:
        columns = self._columns
        t, number = float(columns.t[index]), int(columns.stream[index])
        found, age = self._outcomes.utility(int(columns.worth[index])), t - float(columns.t_gen[index])
        worth: MessageUtility = Aged(found, age) if age > 0.0 else found
        sent = not self._outcomes.streams[number].planned
        return Message(number, t, t, t_rcv, worth, float(columns.scale[index]), use, sent)

    def _added(self, index: int, use: tuple[float, ...], end: float) -> Message:
        """Return a sample that adds to others: it is worth within its piece what it is worth up to the end of all."""
        t, number = float(self._columns.t[index]), int(self._columns.stream[index])
        last = float(self._borders[-1])
        arrival = min(t + self._mission.latency, last)
        (worth,) = self._gains.worth(np.array([index]), np.array([arrival]), np.array([last])).tolist()
        t_rcv = min(t + self._mission.latency, (t + end) / 2) if end - t > SOON else t
        sent = not self._outcomes.streams[number].planned
        return Message(number, t, t, t_rcv, CONSTANT, worth / (end - t_rcv), use, sent)

    def _carry(self, here: Ints, end: float) -> None:
        """Note what may have been received when the next piece begins."""
        columns, by_stream = self._columns, self._columns.stream[here]
        for number in np.unique(by_stream).tolist():
            stream = self._outcomes.streams[number]
            if stream.covering is None or stream.aggregation is Aggregation.SUM:
                continue
            known = np.concatenate((self._carried.get(number, here[:0]), here[by_stream == number]))
            there = columns.t[known] + self._mission.latency <= end
            self._carried[number] = np.concatenate((undominated(self._outcomes, columns, known[there]), known[~there]))
