"""Beam search: level by level the best nodes live, of tantamount ones the one of the greatest value.

Nodes are ranked by their value, or by the bound that the prices of best mode give: value and what may still come. Then
nodes that cannot beat the best plan so far are left out, and when nothing else was, that plan is proven. While it is
not, a *widening* beam begins anew, wider: so it is any-time, and ends with the best plan.
"""

from collections.abc import Hashable
from dataclasses import dataclass

from planner.python_engine.best import Node
from planner.python_engine.path import Path
from planner.python_engine.prices import Prices
from planner.tables import Tables
from studies.designs.ablations import Best, Deflected

Key = tuple[tuple[Hashable, ...], tuple[int, ...]]


@dataclass(frozen=True, slots=True)
class Place:
    """A node of the beam and the path to it."""

    node: Node
    sends: list[int]
    state: list[int]
    used: list[list[float]]


class Beam(Best):
    """Extends the `width` best nodes of each level; with `by_bound` it learns prices first, as best mode does."""

    def __init__(
        self, tables: Tables, width: int, *, by_bound: bool, prices: Prices | None = None, path: Path | None = None
    ) -> None:
        super().__init__(tables, prices, path)
        self._width = width
        self._by_bound = by_bound
        self._waiting: list[Place] = []
        self._next: dict[Key, Place] = {}
        self._narrowed = False
        if not tables.gains.closed:
            raise ValueError("beam search needs the states of all streams in the tables")

    @property
    def proven(self) -> bool:
        """Whether no plan is better."""
        return self.done and not self._narrowed

    def _iterate(self) -> None:
        if self._by_bound and self._prices.learning:
            self._learn()
            return
        if not self._waiting:
            self._waiting = [self._root()]
        self._extend(self._waiting.pop())
        if not self._waiting:
            self._descend()

    def _root(self) -> Place:
        self._path.reset()
        return self._place(Node(0, None, 0, send=False, value=self._tables.gains.aim_facts, bound=self._prices.bound))

    def _descend(self) -> None:
        """Go on to the next level with the best nodes of it."""
        ranked = sorted(self._next.values(), key=lambda place: self._rank(place.node))
        self._waiting, self._next = ranked[-self._width :], {}
        self._narrowed = self._narrowed or len(ranked) > self._width
        if not self._waiting or self._waiting[0].node.level == self._tables.levels:
            self._end()

    def _rank(self, node: Node) -> float:
        return node.bound if self._by_bound else node.value

    def _extend(self, place: Place) -> None:
        """Give a node its children, unless tantamount nodes are as good."""
        node, path = place.node, self._path
        for send in (False, True):
            path.sends, path.state, path.used = list(place.sends), list(place.state), list(place.used)
            if send and not path.fits(node.level):
                continue
            value = node.value + path.gain(node.level) if send else node.value
            bound = self._bound_after(node, self._prices.advantage(node.level), send=send)
            if self._by_bound and not self._worth_trying(bound):
                continue
            key = (path.states(node.level, send=send), path.held(node.level, send=send))
            if key in self._next and self._next[key].node.value >= value:
                continue
            path.step(node.level, send=send)
            self._next[key] = self._place(Node(0, None, node.level + 1, send, value, bound))

    def _place(self, node: Node) -> Place:
        return Place(node, self._path.sends, self._path.state, self._path.used)

    def _end(self) -> None:
        """All nodes left are whole plans."""
        self.done = True
        for place in self._waiting:
            self._path.sends = place.sends
            self._found(place.node.value)


class WideningBeam(Beam):
    """A beam by bound with prices learned along deflected directions, `factor` times as wide whenever it was narrow."""

    def __init__(self, tables: Tables, *, width: int, factor: int, rounds: int) -> None:
        path = Path(tables)
        super().__init__(tables, width, by_bound=True, prices=Deflected(tables, path, rounds), path=path)
        self._factor = factor

    def _end(self) -> None:
        super()._end()
        if self._narrowed:
            self._width *= self._factor
            self._waiting, self._narrowed, self.done = [], False, False
