"""The best plan of whole messages for a mission, found piece by piece: what it is worth, and how many bytes it has.

The integer programme of a whole mission seldom ends. That of a few seconds does, with all that was decided before as
facts; so pieces of `LOOK` [s] are solved one after the other, and of each the first `STEP` [s] are kept.
"""

from collections.abc import Collection
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from planner import Problem, Traffic
from planner.definition import utility
from studies.oracle import OracleFailed, Solution, optimum, upper_bound

LOOK, STEP = 5.0, 2.0
"""How far a piece looks, and how much of it is kept [s]."""


@dataclass(frozen=True, slots=True)
class Plan:
    """`sends` by index, the `bytes` of those that are generated at `since` or later, and their number.

    No plan with its certain messages is worth more than `bound` [utility·s]: that is the linear programme's, which may
    send fractions. `gap` is what the plan lacks of it, as a part. It took `seconds`, of which the bound `bounding`.
    """

    sends: tuple[int, ...]
    utility: float
    bytes: float
    bound: float
    seconds: float
    bounding: float

    @property
    def gap(self) -> float:
        """What the plan lacks of the bound, as a part of it."""
        return 1.0 - self.utility / self.bound


def best_plan(problem: Problem, *, certain: Collection[int] = (), since: float = 0.0, time_limit: float = 60.0) -> Plan:
    """Plan a mission of open messages whose first constraint counts bytes, within about `time_limit` [s].

    `certain` messages, by index, are sent in any case: small ones, of which nobody doubts it. Raises what `upper_bound`
    raises.
    """
    begin = perf_counter()
    sends = _Pieces(problem, frozenset(certain), time_limit).plan()
    planned = perf_counter()
    highest = bound(problem, certain).bound
    end = perf_counter()
    messages = problem.messages
    return Plan(
        sends,
        utility(problem, sends),
        sum(messages[i].use[0] for i in sends if messages[i].t_gen >= since),
        highest,
        end - begin,
        end - planned,
    )


def bound(problem: Problem, certain: Collection[int] = (), every: float = 0.0) -> Solution:
    """Solve the linear programme of a mission in which the `certain` messages, all of some streams, are sent.

    It is the bound of the mission itself as long as that would send them, too: as small ones among large ones it does.
    Of windows that end less than `every` [s] apart it looks at one. Raises what `upper_bound` raises.
    """
    if not certain:
        return upper_bound(problem, every)
    messages, chosen = problem.messages, frozenset(certain)
    opened = [i for i in range(len(messages)) if i not in chosen]
    rest = replace(
        problem,
        messages=tuple(messages[i] for i in opened),
        traffic=tuple(Traffic(messages[i].t_sent, messages[i].use) for i in sorted(chosen)),
    )
    found = upper_bound(rest, every)
    sends = np.ones(len(messages))
    sends[opened] = found.sends
    given = utility(problem, chosen)
    return Solution(found.utility + given, sends, exact=found.exact, bound=found.bound + given)


class _Pieces:
    """A mission planned piece by piece."""

    def __init__(self, problem: Problem, certain: frozenset[int], time_limit: float) -> None:
        self._problem = problem
        self._certain = certain
        self._each = time_limit * STEP / max(problem.t_end - problem.t_start, STEP)
        self._times = np.array([m.t_sent for m in problem.messages])
        self._reach = max((c.window for c in problem.constraints), default=0.0)
        self._sent: dict[int, None] = {}

    def plan(self) -> tuple[int, ...]:
        """Return all sends of the mission, in order."""
        for at in np.arange(self._problem.t_start, self._problem.t_end, STEP).tolist():
            self._decide(at)
        return tuple(sorted({*self._sent, *self._certain}))

    def _decide(self, at: float) -> None:
        """Decide what is generated within a step from a time on."""
        opened = [i for i in self._between(at, at + LOOK) if i not in self._certain]
        if not opened:
            return
        piece, numbers = self._piece(at, opened)
        try:
            found = optimum(piece, self._each)
        except OracleFailed:
            return
        for place in np.flatnonzero(found.sends).tolist():
            if self._times[numbers[place]] < at + STEP:
                self._sent[numbers[place]] = None

    def _piece(self, at: float, opened: list[int]) -> tuple[Problem, list[int]]:
        """Return the programme of some messages, and which of the mission each of its messages is."""
        messages = self._problem.messages
        last = {messages[i].stream: i for i in self._sent}
        recent = {i for i in self._sent if self._times[i] >= at - self._reach}
        facts = sorted({*last.values(), *recent})
        certain = [i for i in self._between(at - self._reach, at + LOOK) if i in self._certain]
        piece = replace(
            self._problem,
            messages=(*(messages[i]._replace(sent=True) for i in facts), *(messages[i] for i in opened)),
            traffic=tuple(Traffic(messages[i].t_sent, messages[i].use) for i in certain),
            current=len(facts),
            t_end=min(self._problem.t_end, at + LOOK),
        )
        return piece, [*facts, *opened]

    def _between(self, begin: float, end: float) -> list[int]:
        return list(range(*np.searchsorted(self._times, (begin, end), "left").tolist()))
