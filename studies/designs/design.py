"""What all designs have in common: a search over the tables of a window, and a decider that counts its work."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol

from planner import Problem
from planner.python_engine.path import Path
from planner.tables import Tables


class Sought(Protocol):
    """A search for the best plan of a window.

    An iteration is a round of learning or one node that is tried; a plan is *completed* when all messages up to the
    end of the window are decided.
    """

    @property
    def tables(self) -> Tables:
        """What is searched; its gains say what is maximised."""

    @property
    def iterations(self) -> int:
        """Iterations done so far."""

    @property
    def plans(self) -> int:
        """Plans completed so far."""

    @property
    def done(self) -> bool:
        """Whether the search can do no more."""

    def run(self, iterations: int) -> int:
        """Run at most `iterations` more; return how many ran."""

    def sends(self) -> Sequence[int]:
        """Return the levels that the best plan found sends."""


Start = Callable[[Problem], Sought]
"""Starts the search of one window."""


@dataclass(frozen=True, slots=True)
class Design:
    """A design by name, with its budget [iterations]. `begin` begins a mission: what it returns may remember."""

    name: str
    begin: Callable[[], Start]
    budget: int

    def decider(self) -> "Decider":
        """Return what decides the windows of one mission in turn."""
        return Decider(self.begin(), self.budget)


@dataclass(slots=True)
class Decider:
    """Decides window after window and counts what that takes."""

    start: Start
    budget: int
    decisions: int = 0
    iterations: int = 0
    plans: int = 0

    def decide(self, window: Problem) -> bool:
        """Search the window; return whether to send its current message."""
        search = self.search(window)
        return search.tables.current in search.sends()

    def search(self, window: Problem) -> Sought:
        """Search the window within the budget."""
        search = self.start(window)
        search.run(self.budget)
        self.decisions += 1
        self.iterations += search.iterations
        self.plans += search.plans
        return search


def worth(tables: Tables, sends: Iterable[int]) -> float:
    """Return what is maximised, of the plan that sends these levels: more than of the facts alone [utility·s]."""
    path, chosen, total = Path(tables), set(sends), 0.0
    for level in range(tables.levels):
        total += path.gain(level) if level in chosen else 0.0
        path.step(level, send=level in chosen)
    return total
