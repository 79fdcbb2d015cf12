"""UCT whose leaves a default policy completes: mean scores guide it, the best plan completed is its answer.

The score of a plan is its value, from 0 for the worst completed so far to 1 for the best.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from planner.python_engine.path import Path
from planner.python_engine.prices import Prices
from planner.tables import Tables


class DefaultPolicy(Protocol):
    """Says what to send at the end of a path."""

    @property
    def learning(self) -> bool:
        """Whether it wants to learn from another plan first."""

    def learn(self, reached: float) -> None:
        """Learn from the best plan so far, which has `reached` a value [utility·s]."""

    def wants(self, level: int) -> bool:
        """Whether to send the message of this level if it fits."""


class ByGainPerUse:
    """Sends what gains at least so much per use that the channel would carry all such messages of the window.

    That gain, the critical ratio, is found once, from what each message would gain if it were the only one.
    """

    learning = False

    def __init__(self, tables: Tables, path: Path) -> None:
        self._path = path
        self._share = shares(tables)
        gain = tables.gains.aim[tables.gains.start[:-1]]
        ratio = np.sort(np.maximum(gain, 0.0) / self._share)[::-1]
        times = [m.t_sent for m in tables.problem.messages if not m.sent]
        windows = [(times[-1] - times[0]) / c.window + 1.0 for c in tables.problem.constraints]
        last = int(min(windows, default=math.inf) / max(float(np.mean(self._share)), 1e-9))
        self._critical = float(ratio[last]) if last < len(ratio) else 0.0

    def learn(self, reached: float) -> None:
        """Learn nothing."""

    def wants(self, level: int) -> bool:
        """Whether the message gains enough."""
        gain = self._path.gain(level)
        return gain > 0 and gain >= self._critical * float(self._share[level])


class ByAdvantage:
    """Sends what has a positive advantage, as best mode does (prices.py)."""

    def __init__(self, tables: Tables, path: Path) -> None:
        self._prices = Prices(tables, path)
        self._bound = self._prices.relax()

    @property
    def learning(self) -> bool:
        """Whether another round may find better prices."""
        return self._prices.learning

    def learn(self, reached: float) -> None:
        """End a round of learning and begin the next."""
        self._prices.learn(self._bound, reached)
        if self._prices.learning:
            self._bound = self._prices.relax()

    def wants(self, level: int) -> bool:
        """Whether sending has an advantage."""
        return self._prices.advantage(level) > 0


@dataclass(slots=True, eq=False)
class Node:
    """The levels before `level` are decided; `sum` adds up the values of the plans completed through here."""

    level: int
    visits: int = 0
    sum: float = 0.0
    children: dict[bool, "Node"] = field(default_factory=dict)


class CompletedUct:
    """UCT with roll-outs."""

    def __init__(self, tables: Tables, policy: type[ByGainPerUse] | type[ByAdvantage], exploration: float) -> None:
        self.tables = tables
        self._exploration = exploration
        self._path = Path(tables)
        self._policy: DefaultPolicy = policy(tables, self._path)
        self._root = Node(0)
        self._low = math.inf
        self._best: tuple[float, list[int]] = (-math.inf, [])
        self.iterations = 0
        self.plans = 0
        self.done = False

    def run(self, iterations: int) -> int:
        """Run so many more iterations; return how many ran."""
        for _ in range(iterations):
            self._iterate()
        self.iterations += iterations
        return iterations

    def sends(self) -> Sequence[int]:
        """Return the levels that the best plan completed sends."""
        return self._best[1]

    def _iterate(self) -> None:
        self._path.reset()
        if self._policy.learning:
            self._complete(0, self.tables.gains.aim_facts)
            self._policy.learn(self._best[0])
            return
        visited, value = self._descend()
        value = self._complete(visited[-1].level, value)
        for node in visited:
            node.visits += 1
            node.sum += value

    def _descend(self) -> tuple[list[Node], float]:
        """Walk down by UCT to a new node; return the nodes on the way and the value so far."""
        visited, value = [self._root], self.tables.gains.aim_facts
        while visited[-1].visits and (level := visited[-1].level) < self.tables.levels:
            node = visited[-1]
            send = self._choose(node)
            value += self._path.gain(level) if send else 0.0
            self._path.step(level, send=send)
            visited.append(node.children.setdefault(send, Node(level + 1)))
        return visited, value

    def _choose(self, node: Node) -> bool:
        """Return the decision of the greatest UCT, one that was never taken before all; first what the policy wants."""
        if not self._path.fits(node.level):
            return False
        wanted = self._policy.wants(node.level)
        for send in (wanted, not wanted):
            if send not in node.children:
                return send
        log_visits = math.log(node.visits)
        return max((wanted, not wanted), key=lambda send: self._uct(node.children[send], log_visits))

    def _uct(self, node: Node, log_visits: float) -> float:
        spread = self._best[0] - self._low
        score = (node.sum / node.visits - self._low) / spread if spread > 0 else 0.0
        return score + self._exploration * math.sqrt(log_visits / node.visits)

    def _complete(self, level: int, value: float) -> float:
        """Decide the rest by the default policy; return the value of the plan."""
        for at in range(level, self.tables.levels):
            send = self._policy.wants(at) and self._path.fits(at)
            value += self._path.gain(at) if send else 0.0
            self._path.step(at, send=send)
        self.plans += 1
        self._low = min(self._low, value)
        if value > self._best[0]:
            self._best = (value, list(self._path.sends))
        return value


def shares(tables: Tables) -> "np.ndarray[tuple[int], np.dtype[np.float64]]":
    """Return the greatest share of a limit that each level uses; a little for one that uses nothing."""
    limits = np.array([max(constraint.limit, 1e-9) for constraint in tables.problem.constraints])
    share = (tables.checks.share[:, : len(limits)] / limits).max(axis=1, initial=0.0)
    return np.where(share > 0, share, 1e-9)
