"""HiGHS on a programme: with fractions by column generation, with whole messages by branch and bound."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from planner.utility import Flags, Floats, Ints
from studies.oracle.errors import OracleFailed
from studies.oracle.programme import Programme
from studies.oracle.scipy import load

FIRST_SKIPS = 12
"""Arcs that skip at most so many messages, and so many ranks, are in the first programme; few others are needed."""

CROWDED = 2.5
"""Where windows have room for one message in so many, arcs that skip so many times this are in it, too: without them a
mission of eight cameras with room for one frame in twenty took over 150 s instead of 9 s."""

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
    """Solve with fractions: start with the short arcs and the first ranks, and add those that matter.

    At most one unit leaves each node, so arcs left out can lower the cost by no more than the price of the most
    helpful one of each node. Ranks left out count as reached, so they can raise it by no more than those are worth that
    are not. When both is little the arcs' part goes into the bound, the ranks' into the cost.
    """
    tail = _tails(programme)
    chosen = programme.skips <= max(FIRST_SKIPS, CROWDED * _crowding(programme))
    is_rank = np.arange(len(chosen)) >= len(chosen) - len(programme.ranks.rank)
    while True:
        found = _linear(programme, chosen)
        x = is_rank.astype(np.float64)
        x[chosen] = found.x
        bound = float(programme.cost @ x)
        price = np.where(chosen | is_rank, 0.0, programme.cost - programme.balance.T @ found.eqlin.marginals)
        helpful = np.zeros(len(programme.supply))
        np.minimum.at(helpful, tail[price < 0], price[price < 0])
        bound += float(helpful.sum())
        x[is_rank] = np.where(chosen[is_rank], x[is_rank], programme.ranks.values(programme.sends(x)))
        cost = float(programme.cost @ x)
        if cost - bound <= CLOSE * abs(cost):
            return Answer(x, cost, bound, best=cost - bound <= NOTHING * abs(cost))
        chosen |= (price < 0) | (is_rank & (x < 1))


def _crowding(programme: Programme) -> float:
    """Return how often all messages of a window exceed the room in it, by the mean."""
    windows = np.flatnonzero(programme.room > 0)
    asked = programme.most.tocsr()[windows] @ np.ones(len(programme.cost))
    return float(np.mean(asked / programme.room[windows])) if len(windows) else 0.0


def _tails(programme: Programme) -> Ints:
    """Return the node where the arc of each column begins; any for columns that are no arcs."""
    entries = programme.balance.tocoo()
    tail = np.zeros(len(programme.cost), dtype=np.int64)
    tail[entries.col[entries.data < 0]] = entries.row[entries.data < 0]
    return tail


def _linear(programme: Programme, chosen: Flags) -> Any:
    """Solve the programme of the chosen columns, without the rows of ranks that are not chosen.

    Interior point beats the simplex method by a factor of up to ten on paths, because the streams compete for every
    window, and is beaten by as much on ranks.
    """
    holds = abs(programme.most) @ (~chosen).astype(np.float64) == 0
    found = load("optimize").linprog(
        programme.cost[chosen],
        A_ub=programme.most[:, chosen][holds],
        b_ub=programme.room[holds],
        A_eq=programme.balance[:, chosen],
        b_eq=programme.supply,
        bounds=np.column_stack((programme.lowest[chosen], programme.highest[chosen])),
        method="highs-ds" if len(programme.ranks.rank) else "highs-ipm",
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
        constraints.append(optimize.LinearConstraint(programme.most, -np.inf, programme.room))
    is_message = np.arange(len(programme.cost)) < programme.messages
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
