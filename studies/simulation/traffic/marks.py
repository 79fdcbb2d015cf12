"""What flights are compared with, as far as it was flown: the central decider, and the bound."""

from collections.abc import Iterable

from studies.simulation.traffic.comparison import Result

Key = tuple[str, int, float, int]


class Marks:
    """Utilities to compare with, as far as they are known: of central deciders by cell, of bounds whatever the loss."""

    def __init__(self, results: Iterable[Result] = ()) -> None:
        self._central: dict[object, Result] = {}
        self._bound: dict[Key, float] = {}
        for result in results:
            self.add(result)

    def add(self, result: Result) -> None:
        """Remember the result if others are compared with it."""
        if result.task.contender == "central":
            self._central[result.task.cell] = result
        if result.task.contender == "bound":
            self._bound[_key(result)] = result.utility

    def of_central(self, result: Result) -> float | None:
        """Return the utility as a part of the central decider's."""
        central = self._central.get(result.task.cell)
        return _ratio(result.utility, central.utility if central else None)

    def of_bound(self, result: Result) -> float | None:
        """Return the utility as a part of the bound."""
        return _ratio(result.utility, self._bound.get(_key(result)))

    def large(self, result: Result) -> float | None:
        """Return the utility of what is not small as a part of the central decider's."""
        central = self._central.get(result.task.cell)
        return _ratio(result.score.large, central.score.large) if central and central.score and result.score else None


def _ratio(utility: float, of: float | None) -> float | None:
    return utility / of if of else None


def _key(result: Result) -> Key:
    cell = result.task.cell
    return cell.workload, cell.robots, cell.latency, cell.seed
