"""Tables made with NumPy, of problems of any kinds: for who reads them, and for an operator's own models."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from planner.beyond import Beyond, look_beyond
from planner.constraints import Checks, overfilled, tabulate_checks
from planner.evaluation import Gains, tabulate_gains
from planner.problem import Problem
from planner.utility import Floats, Ints

SHORTEST_PROGRESS = 0.01
"""The least time that counts as progress of the mission in ψ [s] (Eq. 2)."""


@dataclass(frozen=True, slots=True)
class NumpyTables:
    """`Tables` made with NumPy."""

    problem: Problem
    message: Sequence[int]
    current: int
    gains: Gains
    beyond: Beyond | None
    checks: Checks
    scale: Floats

    @property
    def levels(self) -> int:
        """The number of open messages."""
        return len(self.message)

    @property
    def streams(self) -> int:
        """The number of streams that have open messages."""
        return len(self.gains.markovian)

    @property
    def states(self) -> Ints:
        """How many states each stream may be in."""
        states = np.ones(self.streams, dtype=np.int64)
        np.maximum.at(states, self.gains.stream, np.diff(self.gains.start))
        at = np.repeat(self.gains.stream, np.diff(self.gains.start))
        np.maximum.at(states, at, self.gains.after + 1)
        return states

    @property
    def constraint(self) -> Sequence[int]:
        """By column of the checks: the constraint."""
        constraint: list[int] = self.checks.constraint.tolist()
        return constraint

    @property
    def closed(self) -> bool:
        """Whether no stream has more states than the table holds."""
        return self.gains.closed

    @property
    def exact(self) -> bool:
        """Whether they say what plans are worth."""
        return self.gains.exact

    def worth(self, sends: Sequence[int]) -> tuple[float, float]:
        """Return what the search maximises, and U, of the plan that sends these levels, in order [utility·s]."""
        gains, state = self.gains, [0] * self.streams
        entries = []
        for level in sends:
            entry = int(gains.start[level]) + state[gains.stream[level]]
            state[gains.stream[level]] = int(gains.after[entry])
            entries.append(entry)
        return gains.aim_facts + float(gains.aim[entries].sum()), gains.facts + float(gains.gain[entries].sum())

    def overfilled(self, sends: Sequence[int]) -> frozenset[int]:
        """Return the constraints that sending these levels breaks."""
        return overfilled(self.checks, sends)

    def charged(self) -> list[float]:
        """Return what each constraint charges for the current message beyond the window [utility·s]."""
        if self.beyond is None:
            return [0.0] * len(self.problem.constraints)
        charges: list[float] = self.beyond.charges[self.message[self.current]].tolist()
        return charges


def tabulate_with_numpy(problem: Problem, *, beyond: bool = False) -> NumpyTables:
    """Tabulate a valid problem of any kinds; raise ProblemError when it is too large or not finite."""
    opened = problem.columns.opened
    left = look_beyond(problem) if beyond else None
    gains = tabulate_gains(problem, left)
    return NumpyTables(
        problem=problem,
        message=opened.tolist(),
        current=int(np.searchsorted(opened, problem.current)),
        gains=gains,
        beyond=left,
        checks=tabulate_checks(problem),
        scale=_score_scale(problem, opened, gains.everything),
    )


def _score_scale(problem: Problem, opened: Ints, everything: float) -> Floats:
    """ψ(v)·U(M) for every level; infinite when that is nothing, or too little to divide by: then every score is 0."""
    next_generated = np.append(problem.columns.t_gen[opened], problem.t_end)
    progress = np.maximum(next_generated - problem.t_start, SHORTEST_PROGRESS) / (problem.t_end - problem.t_start)
    scale = progress * everything
    return np.where(scale >= np.finfo(np.float64).tiny, scale, np.inf)
