"""Tables made in C++: what `Tables` say, as NumPy arrays for whoever reads them."""

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

from planner._native import Tabulated
from planner.problem import Problem
from planner.utility import Floats, Ints

if TYPE_CHECKING:
    from planner.beyond import Beyond
    from planner.constraints import Checks
    from planner.evaluation import Gains


class NativeTables:
    """`Tables` of a problem of standard kinds. The native engine searches `tabulated`; arrays are made on demand."""

    closed = True

    def __init__(self, problem: Problem, tabulated: Tabulated) -> None:
        self.problem = problem
        self.tabulated = tabulated
        self.current = tabulated.current
        self.levels = tabulated.levels
        self.streams = tabulated.streams
        self.exact = tabulated.exact

    @cached_property
    def message(self) -> Sequence[int]:
        """By level: which message of the problem it decides."""
        return self.tabulated.message

    @cached_property
    def gains(self) -> "Gains":
        """What sending adds."""
        from planner.evaluation import Gains

        return Gains(*self.tabulated.gains(), open_ended=(None,) * self.streams)

    @cached_property
    def beyond(self) -> "Beyond | None":
        """What a plan leaves behind, where the objective is maximised and not U."""
        from planner.beyond import Beyond

        left = self.tabulated.beyond()
        if left is None:
            return None
        worth, charges, price, rent, until = left
        return Beyond(worth, charges.reshape(len(worth), len(price)), price, rent, until)

    @cached_property
    def checks(self) -> "Checks":
        """What must hold for sending."""
        from planner.constraints import Checks, Rows

        use, share, start, of, first, room, held, never, rows, constraint = self.tabulated.checks()
        shape = (self.levels, len(constraint))
        return Checks(
            use.reshape(shape), share.reshape(shape), start, of, first, room, held, never, Rows(*rows), constraint
        )

    @cached_property
    def scale(self) -> Floats:
        """scale[d]: what turns the utility of a node of level d into its score, ψ·U(M) of Eq. 2 [utility·s]."""
        return self.tabulated.scale()

    @property
    def constraint(self) -> Sequence[int]:
        """By column of the checks: the constraint."""
        return self.tabulated.constraint

    @property
    def states(self) -> Ints:
        """How many states each stream may be in."""
        return self.tabulated.states()

    def worth(self, sends: Sequence[int]) -> tuple[float, float]:
        """Return what the search maximises, and U, of the plan that sends these levels, in order [utility·s]."""
        return self.tabulated.worth(sends)

    def overfilled(self, sends: Sequence[int]) -> frozenset[int]:
        """Return the constraints that sending these levels breaks."""
        return frozenset(self.tabulated.overfilled(sends))

    def charged(self) -> list[float]:
        """Return what each constraint charges for the current message beyond the window [utility·s]."""
        return self.tabulated.charged()
