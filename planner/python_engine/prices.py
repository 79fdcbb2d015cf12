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
        self._facts = gains.aim_facts
        self._gain: list[float] = gains.aim.tolist()
        self._width: list[int] = np.diff(gains.start).tolist()
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
        self._worth = [[0.0] * count for count in tables.states.tolist()]
        self._open_ended = [model is not None for model in gains.open_ended]
        self._advantage = [0.0] * len(self._gain)
        self.bound = math.inf
        """No plan is worth more than this [utility·s]."""
        self._closing: list[list[Row]] = [[] for _ in range(tables.levels)]
        """The rows with a price, by their last level."""
        self._round = 0
        self._step = FIRST_STEP
        self._stale = 0
        self._best = [0.0] * len(self._rows)
        self.learning = True
        """Whether another round may find a better bound."""

    def advantage(self, level: int) -> float:
        """Return what sending gains over dropping at the end of the path, net of prices [utility·s].

        What the table only guesses, as a stream has more states than it holds, is put right by what is known.
        """
        entry = self._path.entry(level)
        if self._open_ended[self._path.stream[level]]:
            return self._advantage[entry] + self._path.gain(level) - self._gain[entry]
        return self._advantage[entry]

    def loss(self, level: int, *, send: bool) -> float:
        """Return what a decision takes off the bound: what it loses, and what it leaves unused [utility·s]."""
        advantage = self.advantage(level)
        lost = max(0.0, -advantage) if send else max(0.0, advantage)
        return lost + self.left_unused(level, send=send)

    def asked(self, level: int) -> list[float]:
        """Return what sending a message is charged by each constraint at the prices that bound best [utility·s]."""
        asked = [0.0] * self._constraints
        for row, multiplier in zip(self._rows, self._best, strict=True):
            if row.first <= level <= row.last:
                asked[row.of] += multiplier * self._share[level][row.of]
        return asked

    def left_unused(self, level: int, *, send: bool) -> float:
        """Return what the rows that end with this level leave of their capacity, at their prices [utility·s].

        The bound had sold that capacity; once a row is decided it is known to be lost.
        """
        loss, used = 0.0, self._path.used
        for row in self._closing[level]:
            sent = self._use[level][row.of] if send else 0.0
            loss += row.multiplier * max(0.0, row.capacity - (used[level][row.of] + sent - used[row.first][row.of]))
        return loss

    def relax(self) -> float:
        """Begin a round: take the next prices, return the optimum of the relaxed problem."""
        bound = self._relax()
        self._stale = 0 if bound < self.bound - PROGRESS * abs(bound) else self._stale + 1
        if bound < self.bound:
            self.bound, self._best = bound, [row.multiplier for row in self._rows]
        if self._stale > PATIENCE:
            self._step, self._stale = self._step * STEP_SHRINKS, 0
            self._set(self._best)
            bound = self._relax()
        return bound

    def learn(self, bound: float, reached: float) -> None:
        """End a round that relaxed to `bound`, when the best plan so far has `reached` a value [utility·s]."""
        gap = bound - reached
        self._round += 1
        closed = gap <= CLOSED_GAP * abs(bound)
        if closed or not self._move(self._step * gap) or self._round == ROUNDS:
            self._settle()

    def _settle(self) -> None:
        """Keep the prices of the best bound."""
        self.learning = False
        self._set(self._best)
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
            start, width = self._path.start[level], self._width[level]
            states = worth[self._path.stream[level]]
            for state in range(width):
                sent = self._gain[start + state] + (states[self._path.leads_to[start + state]] - prices[level])
                self._advantage[start + state] = sent - states[state]
            for state in range(width):
                states[state] = max(states[state], states[state] + self._advantage[start + state])
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
            entry = self._path.start[level] + state[stream]
            if self._advantage[entry] > 0:
                state[stream] = self._path.leads_to[entry]
                used.append([before + more for before, more in zip(used[-1], share, strict=True)])
            else:
                used.append(used[-1])
        return [used[row.last + 1][row.of] - used[row.first][row.of] - row.capacity for row in self._rows]
