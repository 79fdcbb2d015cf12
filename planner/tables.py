"""Everything a search needs to know of a problem, as plain arrays that both engines share.

Both engines read the same numbers from here and add them in the same order, so they round alike. Problems of standard
kinds are tabulated in C++ (`native_tables.py`), without NumPy. `NumpyTables` (`numpy_tables.py`) say the same for who
reads it, and tabulate an operator's own models.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

from planner import _native
from planner.native_tables import NativeTables
from planner.problem import Aggregation, Constraint, Message, Problem, Receiver, Stream, Traffic
from planner.utility import STANDARD as UTILITIES
from planner.utility import Floats, Ints

if TYPE_CHECKING:
    from planner.beyond import Beyond
    from planner.constraints import Checks
    from planner.evaluation import Gains

STANDARD = (
    Message,
    Traffic,
    Stream,
    Receiver,
    Constraint,
    tuple(Aggregation),
    UTILITIES,
)
"""The kinds that are tabulated in C++, in the order of its enumerations."""


class Tables(Protocol):
    """One problem, tabulated. Level i of the tree decides its message `message[i]`; `current` is a level."""

    @property
    def problem(self) -> Problem:
        """What was tabulated."""

    @property
    def message(self) -> Sequence[int]:
        """By level: which message of the problem it decides."""

    @property
    def current(self) -> int:
        """The level of the message that the problem asks about."""

    @property
    def gains(self) -> "Gains":
        """What sending adds."""

    @property
    def beyond(self) -> "Beyond | None":
        """What a plan leaves behind, where the objective is maximised and not U."""

    @property
    def checks(self) -> "Checks":
        """What must hold for sending."""

    @property
    def scale(self) -> Floats:
        """scale[d]: what turns the utility of a node of level d into its score, ψ·U(M) of Eq. 2 [utility·s]."""

    @property
    def levels(self) -> int:
        """The number of open messages."""

    @property
    def streams(self) -> int:
        """The number of streams that have open messages."""

    @property
    def states(self) -> Ints:
        """How many states each stream may be in."""

    @property
    def constraint(self) -> Sequence[int]:
        """By column of the checks: the constraint."""

    @property
    def closed(self) -> bool:
        """Whether the tables hold all there is to know."""

    @property
    def exact(self) -> bool:
        """Whether they say what plans are worth; if not, they are close, and nothing is proven by them."""

    def worth(self, sends: Sequence[int]) -> tuple[float, float]:
        """Return what the search maximises, and U, of the plan that sends these levels, in order [utility·s]."""

    def overfilled(self, sends: Sequence[int]) -> frozenset[int]:
        """Return the constraints that sending these levels breaks."""

    def charged(self) -> list[float]:
        """Return what each constraint charges for the current message beyond the window [utility·s]."""


def tabulate(problem: Problem, *, beyond: bool = False) -> Tables:
    """Tabulate a problem, to maximise U or, with `beyond`, the objective; raise ProblemError without meaning."""
    native = _native.tabulate(problem, STANDARD, beyond)
    if native is not None:
        return NativeTables(problem, native)
    from planner.numpy_tables import tabulate_with_numpy
    from planner.validation import check_problem

    check_problem(problem)
    return tabulate_with_numpy(problem, beyond=beyond)
