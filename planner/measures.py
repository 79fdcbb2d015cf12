"""Resource measures: what a message uses of a constraint, and how much there is of it (§2.3, Eq. 4).

`Throughput` counts bytes, `Messages` counts messages, `Energy` what sending takes from the battery, and `Airtime` (in
`planner.airtime`) the time that the channel is occupied. Each makes the `Constraint` whose windows it fills. All are
additive: what several messages use together is the sum of what each uses.
"""

import math
from dataclasses import dataclass
from typing import ClassVar, Protocol

from planner.errors import ProblemError
from planner.finite import finite
from planner.problem import Constraint

WINDOW = 0.5
"""The constraint window T where nobody sets another one [s]."""


class Measure(Protocol):
    """A resource: its name, its unit, a limit in that unit for every window, and what a message uses of it."""

    @property
    def kind(self) -> str:
        """What an operator calls it."""

    @property
    def unit(self) -> str:
        """Of `limit` and `use`: `B`, `messages`, `s` or `J`."""

    @property
    def private(self) -> bool:
        """Whether every robot has a budget of its own, so that others' messages use nothing of ours."""

    @property
    def window(self) -> float:
        """The constraint window T [s]."""

    @property
    def limit(self) -> float:
        """What the messages sent within one window may use together [`unit`]."""

    @property
    def pace(self) -> float:
        """Bytes, every copy counted, that the channel carries in a second at most; infinite where that is unknown."""

    def use(self, size: int, copies: int, *, own: bool) -> float:
        """What a message of `size` [B] uses that goes to so many receivers; `own`: whether this robot sends it."""

    def constraint(self, name: str) -> Constraint:
        """Return the constraint of Eq. 5 and 6."""


class Windowed:
    """A measure by its windows."""

    __slots__ = ()

    def constraint(self: Measure, name: str) -> Constraint:
        """Return the constraint of Eq. 5 and 6."""
        return Constraint(name, self.window, self.limit)


@dataclass(frozen=True, slots=True)
class Throughput(Windowed):
    """Bytes in every copy: at most `rate` [B/s] × `window` [s] in any window. Raises ProblemError."""

    kind: ClassVar[str] = "throughput"
    unit: ClassVar[str] = "B"
    private: ClassVar[bool] = False

    rate: float
    window: float = WINDOW

    def __post_init__(self) -> None:
        check_positive(self.kind, rate=self.rate, window=self.window)

    @property
    def limit(self) -> float:
        """Bytes in any window [B]."""
        return self.rate * self.window

    @property
    def pace(self) -> float:
        """The rate itself [B/s]."""
        return self.rate

    def use(self, size: int, copies: int, *, own: bool) -> float:  # noqa: ARG002 - who sends is all the same
        """Bytes times copies [B]."""
        return float(size * copies)


@dataclass(frozen=True, slots=True)
class Messages(Windowed):
    """At most `count` messages in any `window` [s], each counted once however many receive it. Raises ProblemError."""

    kind: ClassVar[str] = "messages"
    unit: ClassVar[str] = "messages"
    private: ClassVar[bool] = False

    count: float
    window: float = WINDOW

    def __post_init__(self) -> None:
        check_positive(self.kind, count=self.count, window=self.window)

    @property
    def limit(self) -> float:
        """Messages in any window."""
        return self.count

    @property
    def pace(self) -> float:
        """Infinite: a message may be of any size."""
        return math.inf

    def use(self, size: int, copies: int, *, own: bool) -> float:  # noqa: ARG002 - a message is a message
        """1 for each message."""
        return 1.0


@dataclass(frozen=True, slots=True)
class Energy(Windowed):
    """What sending takes from this robot's battery: at most `joule` [J] in any `window` [s]. Raises ProblemError.

    A copy of a message takes `per_byte` [J/B] for every byte and `per_message` [J] besides. Others have batteries of
    their own, so their messages use nothing of ours.
    """

    kind: ClassVar[str] = "energy"
    unit: ClassVar[str] = "J"
    private: ClassVar[bool] = True

    joule: float
    window: float = WINDOW
    per_byte: float = 0.0
    per_message: float = 0.0

    def __post_init__(self) -> None:
        check_positive(self.kind, joule=self.joule, window=self.window)
        for name, cost in (("per_byte", self.per_byte), ("per_message", self.per_message)):
            if not (finite(cost) and cost >= 0.0):
                raise ProblemError(f"{self.kind}: {name} must be a finite number >= 0, not {cost}")
        if self.per_byte == self.per_message == 0.0:
            raise ProblemError(f"{self.kind}: a message must cost something, per byte or per message")

    @property
    def limit(self) -> float:
        """Energy in any window [J]."""
        return self.joule

    @property
    def pace(self) -> float:
        """Infinite: a battery does not slow down the channel."""
        return math.inf

    def use(self, size: int, copies: int, *, own: bool) -> float:
        """Energy of all copies [J]; 0 where another robot sends them."""
        return copies * (self.per_byte * size + self.per_message) if own else 0.0


def check_positive(kind: str, **numbers: float) -> None:
    """Raise ProblemError unless all these are finite and above 0."""
    for name, number in numbers.items():
        if not (finite(number) and number > 0.0):
            raise ProblemError(f"{kind}: {name} must be a finite number > 0, not {number}")
