"""The paper's search (§3.1) as it is, and with the maximum in place of the mean.

The mean of a node's scores counts what was tried and given up beside what is best. A maximum forgets it: the score of
a node is that of the best leaf below. UCT, no roll-out and the most visited path remain.
"""

import math
from collections.abc import Sequence
from typing import Literal

from planner.python_engine.paper import PaperSearch
from planner.python_engine.path import Path
from planner.python_engine.prices import Prices
from planner.python_engine.reduction import Reduction
from planner.python_engine.tree import Node, ancestors, subtree
from planner.search import SearchSettings
from planner.tables import Tables


class Paper(PaperSearch):
    """The search of §3.1, which counts how often it gets to the end of the window."""

    def __init__(self, tables: Tables, settings: SearchSettings) -> None:
        super().__init__(tables, settings)
        self.plans = 0

    @property
    def tables(self) -> Tables:
        """What is searched."""
        return self._tables

    def sends(self) -> Sequence[int]:
        """Return the levels that the most visited path sends."""
        sends = set(self.plan().sends)
        return [level for level, message in enumerate(self._tables.message) if message in sends]

    def _select(self) -> Node:
        node = super()._select()
        self.plans += node.level == self._tables.levels
        return node

    def _prices(self, reached: float) -> Prices:
        """Return prices that nobody learns: nothing is explained here."""
        del reached
        return Prices(self._tables, Path(self._tables))


class MaximumBackup(Paper):
    """The same with the score of the best leaf below a node in place of the mean of all."""

    def __init__(self, tables: Tables, settings: SearchSettings) -> None:
        super().__init__(tables, settings)
        self._top: dict[int, float] = {}
        """By index of a visited node: the score of the best leaf below it."""
        if settings.reduction != "off":
            self._reduction = _Watched(self._path, self._scale, settings.reduction)

    def _iterate(self) -> None:
        node = self._select()
        visited = list(ancestors(node))
        if node.level < self._tables.levels:
            self._expand(node)
            self._renew_replaced()
            if self._reduction and self._reduction.cut_if_barren(node):
                self._renew(visited)
                return
        for one in visited:
            one.visits += 1
        self._renew(visited)

    def _uct(self, node: Node, log_visits: float) -> float:
        return self._top[node.index] + self._exploration * math.sqrt(log_visits / node.visits)

    def _renew(self, nodes: Sequence[Node]) -> None:
        """Renew the scores of nodes, children before parents."""
        for node in nodes:
            tops = (self._top[child.index] for child in node.living_children() if child.visits)
            self._top[node.index] = max(tops, default=node.utility / self._scale[node.level])

    def _renew_replaced(self) -> None:
        if isinstance(self._reduction, _Watched):
            for new, above in self._reduction.replaced:
                self._renew(subtree(new)[::-1])
                self._renew([node for node in above if node.alive])
            self._reduction.replaced.clear()


class _Watched(Reduction):
    """The reduction of §3.2.2, which remembers the nodes that replaced others and what was above those."""

    def __init__(self, path: Path, scale: list[float], kind: Literal["paper", "exact"]) -> None:
        super().__init__(path, scale, kind)
        self.replaced: list[tuple[Node, list[Node]]] = []

    def _replace(self, old: Node, new: Node) -> None:
        above = list(ancestors(old.parent))
        super()._replace(old, new)
        self.replaced += [(new, above), (new, list(ancestors(new.parent)))]
