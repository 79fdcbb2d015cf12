"""What a unit of the constraints is worth: the default policy of `best` mode and a bound for every node.

Lagrangian relaxation: give every row "the levels first to last use at most capacity" (constraints.py) a
multiplier μ >= 0 and charge each message the sum of the multipliers of its rows. Without the rows the streams
no longer concern each other, and the best plan of each is a longest path that one backward pass over the
levels finds:

    worth(level, state) = max(worth(level + 1, state), gain − price + worth(level + 1, state after sending))

The *advantage* of sending is the second term less the first. It tells the default policy whether to send, and
what doing otherwise loses at least. For any μ the relaxed optimum bounds all plans from above (weak
duality); the subgradient method looks for the μ that bounds it best. On the way it rolls out the policy of
every round.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from planner.python_engine.path import Path
from planner.tables import Tables

ROUNDS = 100
FIRST_STEP = 1.0
STEP_SHRINKS = 0.7
PATIENCE = 4
"""After this many rounds without a better bound the step shrinks."""
PROGRESS = 1e-4
"""What counts as a better bound, as a part of the gap."""
CLOSED_GAP = 1e-9
"""The gap, as a part of the bound, at which the prices are as good as they get."""


@dataclass(slots=True)
class Row:
    """The levels `first` to `last` use at most `capacity` of constraint `of`; `multiplier` is μ."""

    of: int
    first: int
    last: int
    capacity: float
    multiplier: float = 0.0


class Prices:
    """The advantage of sending each message in each state of its stream, net of what it takes from others."""

    def __init__(self, tables: Tables, path: Path) -> None:
        checks, gains = tables.checks, tables.gains
        rows = checks.rows
        self._path = path
        self._levels = tables.levels
        self._facts = tables.aim_facts
        self._gain: list[float] = tables.aim.tolist()
        self._never: list[bool] = checks.never.tolist()
        self._use: list[list[float]] = checks.use.tolist()
        self._share: list[list[float]] = checks.share.tolist()
        self._constraints = checks.use.shape[1]
        self._rows = [
            Row(*row)
            for row in zip(
                rows.of.tolist(), rows.first.tolist(), rows.last.tolist(), rows.capacity.tolist(), strict=True
            )
        ]
        self._worth = [[0.0] * (count + 1) for count in np.bincount(gains.stream, minlength=tables.streams).tolist()]
        self._advantage = [0.0] * len(self._gain)
        self.bound = math.inf
        """No plan is worth more than this [utility·s]."""
        self._closing: list[list[Row]] = [[] for _ in range(tables.levels)]
        """The rows with a price, by their last level."""

    def advantage(self, level: int) -> float:
        """Return what sending gains over dropping at the end of the path, net of prices [utility·s]."""
        return self._advantage[self._path.start[level] + self._path.state[self._path.stream[level]]]

    def left_unused(self, level: int, *, send: bool) -> float:
        """Return what the rows that end with this level leave of their capacity, at their prices [utility·s].

        The bound had sold that capacity; once a row is decided it is known to be lost.
        """
        loss, used = 0.0, self._path.used
        for row in self._closing[level]:
            sent = self._use[level][row.of] if send else 0.0
            loss += row.multiplier * max(0.0, row.capacity - (used[level][row.of] + sent - used[row.first][row.of]))
        return loss

    def learn(self, roll_out: Callable[[], float]) -> None:
        """Find prices; `roll_out` follows the policy of the present ones and returns the best value so far."""
        best = [0.0] * len(self._rows)
        step, stale = FIRST_STEP, 0
        for _ in range(ROUNDS):
            bound = self._relax()
            stale = 0 if bound < self.bound - PROGRESS * abs(bound) else stale + 1
            if bound < self.bound:
                self.bound, best = bound, [row.multiplier for row in self._rows]
            if stale > PATIENCE:
                step, stale = step * STEP_SHRINKS, 0
                self._set(best)
                bound = self._relax()
            gap = bound - roll_out()
            if gap <= CLOSED_GAP * abs(bound) or not self._move(step * gap):
                break
        self._set(best)
        self.bound = self._relax()
        for row in self._rows:
            if row.multiplier > 0:
                self._closing[row.last].append(row)

    def _set(self, multipliers: list[float]) -> None:
        for row, multiplier in zip(self._rows, multipliers, strict=True):
            row.multiplier = multiplier

    def _relax(self) -> float:
        """Solve the relaxed problem: write the advantages, return its optimum."""
        prices = self._prices()
        worth = self._worth
        for states in worth:
            states[:] = [0.0] * len(states)
        for level in range(self._levels - 1, -1, -1):
            number, start = self._path.number[level], self._path.start[level]
            states = worth[self._path.stream[level]]
            after = states[number + 1] - prices[level]
            for state in range(number + 1):
                sent = self._gain[start + state] + after
                self._advantage[start + state] = sent - states[state]
                states[state] = max(states[state], sent)
        bound = self._facts
        for row in self._rows:
            bound += row.multiplier * row.capacity
        for states in worth:
            bound += states[0]
        return bound

    def _prices(self) -> list[float]:
        """Return what sending each level is charged; no price is high enough for what never fits."""
        change = [[0.0] * self._constraints for _ in range(self._levels + 1)]
        for row in self._rows:
            change[row.first][row.of] += row.multiplier
            change[row.last + 1][row.of] -= row.multiplier
        sums = [0.0] * self._constraints
        prices = []
        for level in range(self._levels):
            price = math.inf if self._never[level] else 0.0
            for k in range(self._constraints):
                sums[k] += change[level][k]
                price += sums[k] * self._share[level][k]
            prices.append(price)
        return prices

    def _move(self, length: float) -> bool:
        """Move the multipliers by `length` along the subgradient; return whether there is any way to go."""
        excess = self._excess()
        norm = 0.0
        for row, over in zip(self._rows, excess, strict=True):
            if row.multiplier > 0 or over > 0:
                norm += over * over
        if norm <= 0:
            return False
        for row, over in zip(self._rows, excess, strict=True):
            row.multiplier = max(0.0, row.multiplier + length / norm * over)
        return True

    def _excess(self) -> list[float]:
        """Return the subgradient: what the relaxed plan uses of each row beyond its capacity."""
        state = [0] * len(self._worth)
        used = [[0.0] * self._constraints]
        for level in range(self._levels):
            stream = self._path.stream[level]
            share = self._share[level]
            if self._advantage[self._path.start[level] + state[stream]] > 0:
                state[stream] = self._path.number[level] + 1
                used.append([before + more for before, more in zip(used[-1], share, strict=True)])
            else:
                used.append(used[-1])
        return [used[row.last + 1][row.of] - used[row.first][row.of] - row.capacity for row in self._rows]
