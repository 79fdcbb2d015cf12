"""HiGHS on a programme: with fractions by column generation, with whole messages by branch and bound."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from planner.utility import Flags, Floats
from studies.oracle.errors import OracleFailed
from studies.oracle.programme import Programme
from studies.oracle.scipy import load

FIRST_SKIPS = 12
"""Arcs that skip at most so many messages are in the first programme; few others are worth adding."""

NOTHING = 1e-9
"""What the solver's rounding may leave to be gained, as a part of the cost."""

CLOSE = 1e-4
"""How far above the cost of the best solution found the bound may lie, as a part of it."""


@dataclass(frozen=True, slots=True)
class Answer:
    """A solution `x`, its cost, a lower bound of any solution's cost, and whether it is the best one."""

    x: Floats
    cost: float
    bound: float
    best: bool


def solve_relaxed(programme: Programme) -> Answer:
    """Solve with fractions: start with the short arcs and add those that help by their price.

    At most one unit leaves each node, so arcs left out can lower the cost by no more than the price of the most
    helpful one of each node. When that is little it goes into the bound. Interior point beats the simplex method
    by a factor of ten here, because the streams compete for every window.
    """
    tail = np.asarray(programme.balance.argmin(axis=0)).ravel()
    chosen = programme.skips <= FIRST_SKIPS
    while True:
        found = _linear(programme, chosen)
        price = np.where(chosen, 0.0, programme.cost - programme.balance.T @ found.eqlin.marginals)
        helpful = np.zeros(len(programme.supply))
        np.minimum.at(helpful, tail, price)
        missed = float(helpful.sum())
        if missed >= CLOSE * found.fun:
            break
        chosen |= price < 0
    x = np.zeros(len(programme.cost))
    x[chosen] = found.x
    return Answer(x, float(found.fun), float(found.fun) + missed, best=missed >= NOTHING * found.fun)


def _linear(programme: Programme, chosen: Flags) -> Any:
    bounds = np.column_stack((programme.lowest[chosen], programme.highest[chosen]))
    found = load("optimize").linprog(
        programme.cost[chosen],
        A_ub=programme.windows[:, chosen],
        b_ub=programme.room,
        A_eq=programme.balance[:, chosen],
        b_eq=programme.supply,
        bounds=bounds,
        method="highs-ipm",
    )
    if found.status != 0:
        raise OracleFailed(f"the linear programme was not solved: {found.message}")
    return found


def solve_integer(programme: Programme, time_limit: float) -> Answer:
    """Solve with whole messages; where every message is sent or not, the arcs come out whole by themselves.

    The solver may run `time_limit` [s]; raise OracleFailed when it found nothing in that time.
    """
    optimize = load("optimize")
    constraints = [optimize.LinearConstraint(programme.balance, programme.supply, programme.supply)]
    if len(programme.room):
        constraints.append(optimize.LinearConstraint(programme.windows, -np.inf, programme.room))
    is_message = np.arange(len(programme.cost)) >= programme.arcs
    limit = {"time_limit": time_limit} if math.isfinite(time_limit) else {}
    found = optimize.milp(
        programme.cost,
        integrality=is_message.astype(np.int64),
        bounds=optimize.Bounds(programme.lowest, programme.highest),
        constraints=constraints,
        options={"mip_rel_gap": 1e-9} | limit,
    )
    if found.x is None:
        raise OracleFailed(f"the integer programme found no plan: {found.message}")
    return Answer(found.x, float(found.fun), float(found.mip_dual_bound), best=found.status == 0)
