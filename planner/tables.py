"""Everything a search needs to know of a problem, as plain arrays that both engines share.

Both engines read the same numbers from here and add them in the same order, so they round alike.
"""

from dataclasses import dataclass

import numpy as np

from planner.beyond import Beyond, look_beyond
from planner.constraints import Checks, tabulate_checks
from planner.evaluation import Gains, tabulate_gains
from planner.problem import Problem
from planner.utility import Floats, Ints
from planner.validation import check_problem

SHORTEST_PROGRESS = 0.01
"""The least time that counts as progress of the mission in ψ [s] (Eq. 2)."""


@dataclass(frozen=True, slots=True)
class Tables:
    """One problem, tabulated. Level i of the tree decides its message `message[i]`; `current` is a level."""

    problem: Problem
    message: Ints
    current: int
    gains: Gains
    beyond: Beyond | None
    checks: Checks
    scale: Floats
    """scale[d]: what turns the utility of a node of level d into its score, ψ·U(M) of Eq. 2 [utility·s]."""

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


def tabulate(problem: Problem, *, beyond: bool = False) -> Tables:
    """Tabulate a problem, to maximise U or, with `beyond`, the objective; raise ProblemError without meaning."""
    check_problem(problem)
    opened = problem.columns.opened
    left = look_beyond(problem) if beyond else None
    gains = tabulate_gains(problem, left)
    return Tables(
        problem=problem,
        message=opened,
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
