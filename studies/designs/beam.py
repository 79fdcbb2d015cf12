"""Beam search: level by level the best nodes live, of tantamount ones the one of the greatest value.

Nodes are ranked by their value, or by the bound that the prices of best mode give: value and what may still come.
"""

from collections.abc import Hashable
from dataclasses import dataclass

from planner.python_engine.best import Node
from planner.tables import Tables
from studies.designs.ablations import Best

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

    def __init__(self, tables: Tables, width: int, *, by_bound: bool) -> None:
        super().__init__(tables)
        self._width = width
        self._by_bound = by_bound
        root = Node(0, None, 0, send=False, value=tables.gains.aim_facts, bound=0.0)
        self._waiting = [self._place(root)]
        self._next: dict[Key, Place] = {}
        if not tables.gains.closed:
            raise ValueError("beam search needs the states of all streams in the tables")

    def _iterate(self) -> None:
        if self._by_bound and self._prices.learning:
            self._learn()
            return
        self._extend(self._waiting.pop())
        if not self._waiting:
            self._waiting = sorted(self._next.values(), key=lambda place: self._rank(place.node))[-self._width :]
            self._next = {}
            if self._waiting[0].node.level == self._tables.levels:
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
