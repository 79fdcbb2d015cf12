"""Best mode that begins with what the last decision found: its prices, its plan.

Consecutive windows have most messages in common. The rows of one are those of the other; each is known by the
message that it ends with.
"""

from dataclasses import dataclass, field

from planner import Problem
from planner.python_engine.path import Path
from planner.python_engine.prices import Prices
from planner.tables import Tables, tabulate
from studies.designs.ablations import Best, Deflected, FewRounds

Name = tuple[int, float]
"""A message of any window: its stream and when it was generated [s]."""


@dataclass(frozen=True, slots=True)
class Prior:
    """What a decision leaves to the next one: the multipliers of its rows and what it planned to send."""

    multipliers: dict[tuple[int, Name], float] = field(default_factory=dict)
    sends: frozenset[Name] = frozenset()


class KnownPrices(FewRounds):
    """Prices that begin where others ended."""

    def __init__(self, tables: Tables, path: Path, rounds: int, prior: Prior) -> None:
        super().__init__(tables, path, rounds)
        self._tables = tables
        for row in self._rows:
            row.multiplier = prior.multipliers.get((row.of, name(tables, row.last)), 0.0)

    def multipliers(self) -> dict[tuple[int, Name], float]:
        """Return what was learned, by constraint and the last message of each row."""
        return {(row.of, name(self._tables, row.last)): row.multiplier for row in self._rows}


class KnownDeflected(KnownPrices, Deflected):
    """The same along deflected directions."""


class Continued(Best):
    """Best mode that starts from a prior; with `follow` the plan of the last decision is the first one."""

    def __init__(self, tables: Tables, prices: Prices, path: Path, follow: frozenset[Name]) -> None:
        super().__init__(tables, prices, path)
        self._follow = follow

    def _learn(self) -> None:
        if self._follow:
            self._path.reset()
            value = self._tables.gains.aim_facts
            for level in range(self._tables.levels):
                send = name(self._tables, level) in self._follow and self._path.fits(level)
                value += self._path.gain(level) if send else 0.0
                self._path.step(level, send=send)
            self._found(value)
            self._follow = frozenset()
        super()._learn()


@dataclass(slots=True)
class Continuing:
    """Starts the searches of one mission, each from what the last one found."""

    rounds: int
    prices: bool = True
    """Whether prices are taken over."""
    plan: bool = False
    """Whether the plan is."""
    kind: type[KnownPrices] = KnownPrices
    _last: tuple[Continued, KnownPrices] | None = None

    def __call__(self, window: Problem) -> Continued:
        """Start the search of the next window."""
        tables, prior = tabulate(window, beyond=True), self._prior()
        path = Path(tables)
        prices = self.kind(tables, path, self.rounds, prior)
        search = Continued(tables, prices, path, prior.sends)
        self._last = search, prices
        return search

    def _prior(self) -> Prior:
        if self._last is None:
            return Prior()
        search, prices = self._last
        sends = frozenset(name(search.tables, level) for level in search.sends())
        return Prior(prices.multipliers() if self.prices else {}, sends if self.plan else frozenset())


def name(tables: Tables, level: int) -> Name:
    """Return the name of the message of a level."""
    message = tables.problem.messages[int(tables.message[level])]
    return message.stream, message.t_gen
