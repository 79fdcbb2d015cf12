"""Best mode with one of its parts left out or replaced, and what can be made of its parts.

Each class changes one thing about `planner.python_engine.best.BestSearch`, which says what the parts are.
"""

from collections.abc import Sequence

from planner.python_engine.best import BestSearch, Node
from planner.python_engine.path import Path
from planner.python_engine.prices import ROUNDS, Prices
from planner.python_engine.sweep import WIDTH, Sweep
from planner.search import SearchSettings
from planner.tables import Tables

KEPT = 0.5
"""How much of its direction the learning of prices keeps from round to round where directions are averaged."""

DEFLECTION = 1.5
"""γ: how strongly a direction avoids what the last one did already."""


class Best(BestSearch):
    """Best mode as it is; it counts the plans that it completes."""

    def __init__(
        self, tables: Tables, prices: Prices | None = None, path: Path | None = None, width: int = WIDTH
    ) -> None:
        super().__init__(tables, SearchSettings())
        if prices is not None and path is not None:
            self._path, self._prices = path, prices
        self._sweep = Sweep(tables, self._path, self._prices, width)
        self.plans = 0

    @property
    def tables(self) -> Tables:
        """What is searched."""
        return self._tables

    @property
    def prices(self) -> Prices:
        """What it learned."""
        return self._prices

    def sends(self) -> Sequence[int]:
        """Return the levels that the best plan found sends."""
        return self._best[self._best[True][0] > self._best[False][0]][1]

    @property
    def proven(self) -> bool:
        """Whether no plan is better."""
        return not self._worth_trying(self._bound())

    def _found(self, value: float) -> None:
        self.plans += 1
        super()._found(value)


class WithoutTree(Best):
    """Learning and the sweep, and no more."""

    def _iterate(self) -> None:
        super()._iterate()
        self.done = self.done or self._sweep.done


class WithoutSweep(Best):
    """From learning straight to the tree."""

    def __init__(self, tables: Tables) -> None:
        super().__init__(tables)
        self._sweep.done = True


class LearningAlone(Best):
    """The plans rolled out while the prices are learned, and no more."""

    def _iterate(self) -> None:
        super()._iterate()
        self.done = self.done or not self._prices.learning


class WithoutDominance(Best):
    """No node is compared with others."""

    def _step(self, parent: Node, *, send: bool, bound: float) -> Node | None:
        self._tantamount.clear()
        return super()._step(parent, send=send, bound=bound)


class FewRounds(Prices):
    """Prices that learn for some rounds only."""

    def __init__(self, tables: Tables, path: Path, rounds: int) -> None:
        super().__init__(tables, path)
        self._round = ROUNDS - rounds


class Averaged(FewRounds):
    """Prices that move along the mean of the subgradient and the direction before, so that zigzag cancels out."""

    def __init__(self, tables: Tables, path: Path, rounds: int) -> None:
        super().__init__(tables, path, rounds)
        self._direction: list[float] = []

    def _excess(self) -> list[float]:
        excess = super()._excess()
        self._direction = self._turn(excess, self._direction) if self._direction else excess
        return self._direction

    def _turn(self, excess: list[float], before: list[float]) -> list[float]:
        """Return the next direction."""
        return [KEPT * old + (1 - KEPT) * new for old, new in zip(before, excess, strict=True)]


class Deflected(Averaged):
    """Prices that keep of the last direction d what the subgradient s turns back on: s + max(0, −γ s·d / d·d) d.

    The rule of Camerini, Fratta and Maffioli (1975), with their γ of 1.5.
    """

    def _turn(self, excess: list[float], before: list[float]) -> list[float]:
        """Return the next direction."""
        back = -sum(old * new for old, new in zip(before, excess, strict=True))
        length = sum(old * old for old in before)
        kept = DEFLECTION * back / length if back > 0 else 0.0
        return [new + kept * old for old, new in zip(before, excess, strict=True)]


class Unlearned(Prices):
    """Prices of zero: the default policy sends what pays its stream, the bound is that of a free channel."""

    def learn(self, bound: float, reached: float) -> None:
        """Learn nothing."""
        del bound, reached
        self._settle()


def without_learning(tables: Tables) -> Best:
    """Return best mode with prices of zero."""
    path = Path(tables)
    return Best(tables, Unlearned(tables, path), path)


def with_prices(tables: Tables, prices: type[FewRounds], rounds: int) -> Best:
    """Return best mode that learns prices of this kind in so many rounds."""
    path = Path(tables)
    return Best(tables, prices(tables, path, rounds), path)
