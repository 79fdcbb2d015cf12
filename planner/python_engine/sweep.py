"""A sweep: level by level from the root to the end of the window, with the best few nodes of each level.

Best-first search (`best.py`) goes where the bound is greatest, and where many bounds hardly differ it tries one
beginning after the other. A sweep comes to the end with several beginnings at once. It ranks nodes by the same bound,
leaves out what cannot beat the best plan so far, and of tantamount nodes keeps the one of the greatest value. When
nothing else was left out, the best plan is proven to be the best.
"""

from collections.abc import Callable, Hashable
from dataclasses import dataclass

from planner.python_engine.path import Path, Snapshot
from planner.python_engine.prices import Prices
from planner.tables import Tables

WIDTH = 10
"""Nodes of a level that are extended."""

State = tuple[tuple[Hashable, ...], tuple[int, ...]]


@dataclass(frozen=True, slots=True)
class Place:
    """A node of the sweep: what the path to it gains, what no plan below it exceeds, and the path [utility·s]."""

    value: float
    bound: float
    path: Snapshot


class Sweep:
    """The nodes of one level, and how to come to the next."""

    def __init__(self, tables: Tables, path: Path, prices: Prices, width: int = WIDTH) -> None:
        self._width = width
        self._levels = tables.levels
        self._start = tables.gains.aim_facts
        self._path = path
        self._prices = prices
        self._level = 0
        self.places: list[Place] = []
        """The nodes to extend, by rising bound; at the end whole plans."""
        self.whole = True
        """Whether nothing was left out that might be better."""
        self.done = False

    def descend(self, worth_trying: Callable[[float], bool]) -> None:
        """Go down one level, along what may be worth trying by its bound."""
        if self._level == 0:
            self._path.reset()
            self.places = [Place(self._start, self._prices.bound, self._path.save())]
        found: dict[State, Place] = {}
        for place in self.places:
            self._extend(place, found, worth_trying)
        ranked = sorted(found.values(), key=lambda place: place.bound)
        self.whole = self.whole and len(ranked) <= self._width
        self.places = ranked[-self._width :]
        self._level += 1
        self.done = self._level == self._levels or not self.places

    def _extend(self, place: Place, found: dict[State, Place], worth_trying: Callable[[float], bool]) -> None:
        """Give a node its children, unless they are not worth it or tantamount ones are as good: drop before send."""
        path, level = self._path, self._level
        for send in (False, True):
            path.load(place.path)
            if send and not path.fits(level):
                continue
            bound = place.bound - self._prices.loss(level, send=send)
            if not worth_trying(bound):
                continue
            value = place.value + path.gain(level) if send else place.value
            state = (path.states(level, send=send), path.held(level, send=send))
            rival = found.get(state)
            if rival is None or value > rival.value:
                path.step(level, send=send)
                found[state] = Place(value, bound, path.save())
