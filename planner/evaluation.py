"""The evaluation model: what a set of messages is worth, as gains that a search adds up (§2.2).

For `most_recent` the utility of a stream is a sum over consecutive received messages, so adding message m' to
what was received changes it by an amount that depends only on the last message before m' and the first after
it. The messages that are known to be sent are fixed, and the open ones are decided in the order in which they
are received. So the gain of sending m' depends only on the stream's *state*: which of its open messages was
the last one sent. All gains of a window are tabulated at once before the search starts.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import cast

import numpy as np

from planner.errors import ProblemError
from planner.problem import Message, Problem
from planner.utility import Batched, Flags, Floats, Ints, MessageUtility

MAX_GAINS = 4_000_000
"""The greatest number of tabulated gains (32 MB); beyond it the horizon is a mistake."""


@dataclass(frozen=True, slots=True)
class Gains:
    """What sending each open message adds, by level and state of its stream.

    Level i decides the i-th open message. `number[i]` counts the open messages of its stream before it. The
    state of a stream is 0 when none of its open messages was sent, else 1 + the number of the last one sent;
    so level i has the states 0 to `number[i]`, and sending it gains `gain[start[i] + state]` [utility·s] and
    leads to the state `number[i] + 1`.
    """

    stream: Ints
    number: Ints
    start: Ints
    gain: Floats
    facts: float
    """U of the messages that are known to be sent [utility·s]."""
    everything: float
    """U(M) of Eq. 2: all messages of the window received [utility·s]."""
    replaced: Ints
    """The message of the problem that each gain takes the place of; −1 for none."""
    lasts: Flags
    """By level: whether nothing known to be sent replaces the message when it was received."""


def tabulate_gains(problem: Problem) -> Gains:
    """Tabulate all gains of a valid problem; raise ProblemError when they are too many or not finite."""
    with np.errstate(over="ignore", invalid="ignore"):
        gains = _Received(problem).gains()
    if not (np.isfinite(gains.gain).all() and np.isfinite(gains.everything) and np.isfinite(gains.facts)):
        raise ProblemError("the utility of the window is not finite: scale or utility parameters are too large")
    return gains


class _Received:
    """The messages of a window in the order of receipt, stream by stream; ties as in the window."""

    def __init__(self, problem: Problem) -> None:
        messages = problem.messages
        columns = np.array([(m.stream, m.sent, m.t_gen, m.t_rcv, m.scale) for m in messages], dtype=np.float64)
        order = np.lexsort((columns[:, 3], columns[:, 0]))
        columns = columns[order]
        self.utilities = [messages[index].utility for index in order]
        self.stream = columns[:, 0].astype(np.int64)
        self.fact = columns[:, 1] != 0
        self.t_gen = columns[:, 2]
        self.t_rcv = np.minimum(columns[:, 3], problem.t_end)
        self.scale = columns[:, 4]
        self.t_end = problem.t_end
        self.order = order
        place = np.empty_like(order)
        place[order] = np.arange(len(order))
        self.open = place[[index for index, m in enumerate(messages) if not m.sent]]
        """Where the message of each level stands in the order of receipt."""

    def gains(self) -> Gains:
        """Tabulate: a message adds its own utility and takes that of the one before, from its receipt on."""
        count = len(self.stream)
        places = np.arange(count)
        fact_before, fact_after = self._facts_around(places)
        open_in_order = np.sort(self.open)
        first = np.searchsorted(self.stream[open_in_order], self.stream[self.open])
        number = np.searchsorted(open_in_order, self.open) - first
        start = np.concatenate(([0], np.cumsum(number + 1)))
        if start[-1] > MAX_GAINS:
            raise ProblemError(f"the window has {start[-1]:,} gains to tabulate, at most {MAX_GAINS:,} are possible")
        level = np.repeat(np.arange(len(number)), number + 1)
        state = np.arange(start[-1]) - start[level]
        sent_before = np.where(state > 0, open_in_order[first[level] + np.maximum(state, 1) - 1], -1)
        before = np.maximum(sent_before, fact_before[self.open[level]])
        after = np.append(self.t_rcv, self.t_end)
        next_received = np.append(np.where(self.stream[1:] == self.stream[:-1], places[1:], count), count)
        facts = np.flatnonzero(self.fact)

        which = np.concatenate((self.open, np.maximum(before, 0), places, facts))
        begin = np.concatenate((self.t_rcv[self.open], self.t_rcv[self.open[level]], self.t_rcv, self.t_rcv[facts]))
        until = np.concatenate((fact_after[self.open], fact_after[self.open[level]], next_received, fact_after[facts]))
        worth = self._worth(which, begin, after[until])
        own, lost, everything, known = np.split(worth, np.cumsum((len(self.open), len(level), count)))
        return Gains(
            stream=self.stream[self.open],
            number=number,
            start=start,
            gain=own[level] - np.where(before >= 0, lost, 0.0),
            facts=float(known.sum()),
            everything=float(everything.sum()),
            replaced=np.where(before >= 0, self.order[before], -1),
            lasts=fact_after[self.open] == count,
        )

    def _facts_around(self, places: Ints) -> tuple[Ints, Ints]:
        """Return the places of the last fact before and the first after each; −1 and the count if none."""
        count = len(places)
        before = np.append(-1, np.maximum.accumulate(np.where(self.fact, places, -1))[:-1])
        after = np.append(np.minimum.accumulate(np.where(self.fact, places, count)[::-1])[::-1][1:], count)
        same_before = (before >= 0) & (self.stream[before] == self.stream)
        same_after = (after < count) & (self.stream[np.minimum(after, count - 1)] == self.stream)
        return np.where(same_before, before, -1), np.where(same_after, after, count)

    def _worth(self, which: Ints, begin: Floats, until: Floats) -> Floats:
        """Scaled ∫ of the utility of message `which[j]` over the times `begin[j]` to `until[j]`."""
        born = self.t_gen[which]
        start = np.maximum(begin - born, 0.0)
        end = np.maximum(until - born, start)
        return self.scale[which] * integrals(self.utilities, which, start, end)


def integrals(utilities: Sequence[MessageUtility], which: Ints, start: Floats, end: Floats) -> Floats:
    """∫ of `utilities[which[j]]` over the ages `[start[j], end[j]]`, kind by kind [1]."""
    kinds = set(map(type, utilities))
    if len(kinds) == 1 and isinstance(utilities[0], Batched):
        batched = cast("type[Batched]", type(utilities[0]))
        return batched.integrals(cast("Sequence[Batched]", utilities), which, start, end)
    result = np.zeros(len(which))
    for kind in sorted(kinds, key=lambda kind: f"{kind.__module__}.{kind.__qualname__}"):
        members = np.array([type(utility) is kind for utility in utilities])
        chosen = members[which]
        result[chosen] = _of_one_kind(kind, utilities, which[chosen], start[chosen], end[chosen])
    return result


def _of_one_kind(
    kind: type[MessageUtility], utilities: Sequence[MessageUtility], which: Ints, start: Floats, end: Floats
) -> Floats:
    if issubclass(kind, Batched):
        used, index = np.unique(which, return_inverse=True)
        return kind.integrals([utilities[at] for at in used], index, start, end)
    result = np.zeros(len(which))
    for at in np.unique(which):
        chosen = which == at
        result[chosen] = utilities[at].integral(start[chosen], end[chosen])
    return result


def utility(problem: Problem, sends: Iterable[int]) -> float:
    """U of the facts and the open messages `sends`, by the definition, message by message [utility·s]."""
    chosen = set(sends)
    total = 0.0
    for stream in range(len(problem.streams)):
        received = sorted(
            (m.t_rcv, index)
            for index, m in enumerate(problem.messages)
            if m.stream == stream and (m.sent or index in chosen) and m.t_rcv < problem.t_end
        )
        for (t_rcv, index), (end, _) in pairwise([*received, (problem.t_end, -1)]):
            total += _worth_between(problem.messages[index], t_rcv, end)
    return total


def _worth_between(message: Message, begin: float, end: float) -> float:
    ages = np.array([begin - message.t_gen]), np.array([end - message.t_gen])
    return message.scale * float(message.utility.integral(*ages)[0])
