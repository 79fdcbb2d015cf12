"""The two questions one can ask the oracle."""

import math
from dataclasses import dataclass

import numpy as np

from planner import Problem
from planner.definition import utility
from planner.utility import Floats
from studies.oracle.programme import build_programme
from studies.oracle.solver import solve_integer, solve_relaxed

WHOLE = 1e-6
"""How far from 0 or 1 a fraction may lie and still count as whole."""


@dataclass(frozen=True, slots=True)
class Solution:
    """What the oracle found.

    `utility` is U of the plan with the facts [utility·s]; that of the linear programme's plan, which may
    send fractions, is the upper bound. `sends[i]` is the fraction of message i that is sent, 1 for facts.
    `exact`: the plan sends no fractions and no plan is better. `bound`: no plan is worth more, whether one
    was found or not.
    """

    utility: float
    sends: Floats
    exact: bool
    bound: float


def upper_bound(problem: Problem, every: float = 0.0) -> Solution:
    """Solve the linear programme: its utility is at least that of any plan that breaks no constraint.

    Of windows that end less than `every` [s] apart it looks at one: sooner solved, and a little higher.

    Raises OracleUnavailable without SciPy, ProblemError for a problem that has no meaning, OracleError for an
    aggregation of the caller's own with too many states, OracleFailed when the solver gives up.
    """
    programme = build_programme(problem, every)
    answer = solve_relaxed(programme)
    sends = programme.sends(answer.x)
    whole = bool(np.abs(sends - np.round(sends)).max() <= WHOLE)
    bound = programme.utility(answer.bound)
    return Solution(utility=bound, sends=sends, exact=whole and answer.best, bound=bound)


def optimum(problem: Problem, time_limit: float = math.inf) -> Solution:
    """Solve the integer programme: the best plan found within `time_limit` [s], `exact` if none is better.

    Raises what `upper_bound` raises; OracleFailed also when the time was up before any plan was found.
    """
    programme = build_programme(problem)
    answer = solve_integer(programme, time_limit)
    sends = np.round(programme.sends(answer.x))
    opened = [index for index in np.flatnonzero(sends).tolist() if not problem.messages[index].sent]
    return Solution(utility(problem, opened), sends, exact=answer.best, bound=programme.utility(answer.bound))
