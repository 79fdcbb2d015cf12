"""The one interface of the planner: settings in, an any-time search, a plan out.

    search = start(problem, SearchSettings(), seed=1)
    while search.iterations < budget and not search.done and not deadline_passed():
        search.run(50)
    plan = search.plan()

The planner reads no clock: the caller stops when its own deadline passes, and the plan says how many
iterations ran.
"""

from dataclasses import dataclass
from typing import Literal, Protocol


@dataclass(frozen=True, slots=True)
class SearchSettings:
    """How to search. `exploration` is c of Eq. 3; `reduction` is that of §3.2.2 (paper mode only).

    A search that has `max_nodes` holds 8 MB at most.
    """

    search: Literal["best", "paper"] = "best"
    engine: Literal["native", "python"] = "native"
    reduction: Literal["off", "paper", "exact"] = "off"
    exploration: float = 0.35
    max_nodes: int = 49_152


@dataclass(frozen=True, slots=True)
class Plan:
    """The answer of a search, and what explains it.

    `send` decides the current message. `sends` are the indices of all open messages that the best plan found
    sends, the current one included when `send`. `utility` is U of that plan with the facts [utility·s];
    `opposite` is that of the best plan found with the opposite decision (None when there is none). `nodes`
    counts the tree.

    The others are of what the search maximises, in best mode U and what is left behind at the end of the window
    (`beyond.py`) [utility·s]. The `lead` is what speaks for the decision: by how much the plan exceeds the other one.
    No plan exceeds it by more than `gap`: 0 when it is proven to be the best, None when no bound is known.
    `prices[k]` is what constraint k asks for sending the current message, by the linear relaxation of the window and
    what lies beyond it, and `binding` names the constraints that ask anything or have no room for it in the plan.
    `earns` is by how much the best plan found that sends the current message exceeds the same one without it; `spared`
    is U of the latter [utility·s]. Both are None when no plan sends it. `seconds` is what the decision took, for the
    caller to fill in.
    """

    send: bool
    sends: tuple[int, ...]
    utility: float
    opposite: float | None
    iterations: int
    nodes: int
    lead: float | None = None
    gap: float | None = None
    prices: tuple[float, ...] = ()
    binding: tuple[str, ...] = ()
    seconds: float | None = None
    earns: float | None = None
    spared: float | None = None


class Search(Protocol):
    """A tree that grows. `done` says that no further iteration can change the decision."""

    @property
    def iterations(self) -> int:
        """Iterations done so far."""

    @property
    def done(self) -> bool:
        """Whether no remaining iteration can change the decision."""

    def run(self, iterations: int) -> int:
        """Run at most `iterations` more; return how many ran (fewer when done)."""

    def plan(self) -> Plan:
        """Return the best answer so far; defined after any number of iterations, zero included."""
