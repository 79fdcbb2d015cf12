"""The constraints that a spec may set, told apart by their `kind`: one table for each resource measure."""

from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from planner.airtime import BASIC_RATE, OVERHEAD, Airtime, Cast, Wifi
from planner.measures import WINDOW, Energy, Measure, Messages, Throughput
from utility_specs.names import Name
from utility_specs.units import Duration, Fraction, Joule, Rate


class ConstraintTable(BaseModel):
    """What every kind of constraint is set by; each adds its `kind`, its limit and a method `measure()`."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


class ThroughputTable(ConstraintTable):
    """At most `limit` × `window` bytes in any window, copies counted (Eq. 5 and 6)."""

    kind: Literal["throughput"]
    name: Name | None = None
    limit: Rate
    window: Duration = WINDOW

    def measure(self) -> Measure:
        """Return the planner's measure."""
        return Throughput(self.limit, self.window)


class MessagesTable(ConstraintTable):
    """At most `limit` messages in any window, each counted once whoever receives it."""

    kind: Literal["messages"]
    name: Name | None = None
    limit: int = Field(ge=1, le=1_000_000)
    window: Duration = WINDOW

    def measure(self) -> Measure:
        """Return the planner's measure."""
        return Messages(self.limit, self.window)


class AirtimeTable(ConstraintTable):
    """The channel is occupied during at most the part `limit` of any window. `rate` is that of the PHY."""

    kind: Literal["airtime"]
    name: Name | None = None
    limit: Fraction
    window: Duration = WINDOW
    rate: Rate
    wifi: Wifi = "adhoc"
    cast: Cast = "unicast"
    multicast_rate: Rate = BASIC_RATE
    hops: int = Field(default=1, ge=1, le=32)
    overhead: Duration | None = None

    def measure(self) -> Measure:
        """Return the planner's measure; a wire has no overhead unless one is set."""
        default = 0.0 if self.wifi == "wired" else OVERHEAD
        return Airtime(
            fraction=self.limit,
            phy_rate=self.rate,
            window=self.window,
            wifi=self.wifi,
            cast=self.cast,
            multicast_rate=self.multicast_rate,
            hops=self.hops,
            overhead=default if self.overhead is None else self.overhead,
        )


class EnergyTable(ConstraintTable):
    """Each robot's own messages take at most `limit` from its battery in any window, copies counted."""

    kind: Literal["energy"]
    name: Name | None = None
    limit: Joule
    window: Duration = WINDOW
    per_byte: Joule | None = None
    per_message: Joule | None = None

    @model_validator(mode="after")
    def _costs_something(self) -> Self:
        if self.per_byte is None and self.per_message is None:
            raise ValueError("needs per_byte or per_message, or both: what does a message cost?")
        return self

    def measure(self) -> Measure:
        """Return the planner's measure."""
        return Energy(self.limit, self.window, self.per_byte or 0.0, self.per_message or 0.0)


AnyConstraintTable = Annotated[
    ThroughputTable | MessagesTable | AirtimeTable | EnergyTable, Field(discriminator="kind")
]
"""The table of any kind of constraint."""
