"""The constraints that a spec may set, told apart by their `kind`: one table for each resource measure.

Limits of the channel are fixed, or `"adaptive"` between a floor and a ceiling: then they follow what the channel bears.
"""

from collections.abc import Callable
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from planner.airtime import BASIC_RATE, OVERHEAD, Airtime, Cast, Wifi
from planner.measures import WINDOW, Energy, Measure, Messages, Throughput
from utility_specs.names import Name
from utility_specs.units import FRACTION, RATE, Duration, Fraction, Joule, Rate

ADAPTIVE = "adaptive"
FLOOR = 0.002
"""The floor of an adaptive limit unless one is set, as a part of its ceiling.

It has to be less than what the radio carries at its worst: with 5 %, and a ceiling of 50 times what the radio carried,
nothing came through for good, as that was two and a half times too much (simulation).
"""


def _or_adaptive(parse: Callable[[Any], float]) -> Callable[[Any], float | str]:
    """Read a quantity, or the word that says that it follows the channel."""
    return lambda written: ADAPTIVE if written == ADAPTIVE else parse(written)


class ConstraintTable(BaseModel):
    """What every kind of constraint is set by; each adds its `kind`, its limit and a method `measure()`."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)

    @property
    def least(self) -> float:
        """The part of the limit that holds whatever the channel does: all of a fixed one."""
        return 1.0


class ChannelTable(ConstraintTable):
    """A limit of the channel. An adaptive one needs a `ceiling`: nobody else knows what the radio could do at best."""

    limit: float | Literal["adaptive"]
    floor: float | None = None
    ceiling: float | None = None

    @model_validator(mode="after")
    def _bounded_if_adaptive(self) -> Self:
        if self.limit != ADAPTIVE:
            if self.floor is not None or self.ceiling is not None:
                raise ValueError('floor and ceiling are for limit = "adaptive"; a fixed limit has none')
        elif self.ceiling is None:
            raise ValueError('limit = "adaptive" needs a ceiling: the most that the channel can carry at its best')
        elif self.floor is not None and self.floor > self.ceiling:
            raise ValueError("floor is above ceiling")
        return self

    @property
    def most(self) -> float:
        """The limit, or the ceiling of an adaptive one."""
        return (self.ceiling or 0.0) if isinstance(self.limit, str) else self.limit

    @property
    def least(self) -> float:
        """The floor of an adaptive limit as a part of its ceiling; 1 for a fixed one."""
        if self.limit != ADAPTIVE:
            return 1.0
        return FLOOR if self.floor is None else self.floor / self.most


class ThroughputTable(ChannelTable):
    """At most `limit` × `window` bytes in any window, copies counted (Eq. 5 and 6)."""

    kind: Literal["throughput"]
    name: Name | None = Field(
        default=None, description="what messages and the status call it; its kind unless it is given"
    )
    limit: Annotated[
        float | Literal["adaptive"], BeforeValidator(_or_adaptive(RATE.parse), json_schema_input_type=str)
    ] = Field(description="the rate at most, or adaptive: it follows the channel", examples=["2 Mbit/s", "adaptive"])
    floor: Rate | None = Field(
        default=None, description="what an adaptive limit never falls below; 0.2 % of the ceiling unless it is given"
    )
    ceiling: Rate | None = Field(
        default=None, description="the most that the channel can carry at its best; an adaptive limit needs it"
    )
    window: Duration = Field(default=WINDOW, description="the limit holds in every window of this length")

    def measure(self) -> Measure:
        """Return the planner's measure, of the ceiling where the limit is adaptive."""
        return Throughput(self.most, self.window)


class MessagesTable(ConstraintTable):
    """At most `limit` messages in any window, each counted once whoever receives it."""

    kind: Literal["messages"]
    name: Name | None = Field(
        default=None, description="what messages and the status call it; its kind unless it is given"
    )
    limit: int = Field(ge=1, le=1_000_000, description="messages in any window")
    window: Duration = Field(default=WINDOW, description="the limit holds in every window of this length")

    def measure(self) -> Measure:
        """Return the planner's measure."""
        return Messages(self.limit, self.window)


class AirtimeTable(ChannelTable):
    """The channel is occupied during at most the part `limit` of any window. `rate` is that of the PHY."""

    kind: Literal["airtime"]
    name: Name | None = Field(
        default=None, description="what messages and the status call it; its kind unless it is given"
    )
    limit: Annotated[
        float | Literal["adaptive"], BeforeValidator(_or_adaptive(FRACTION.parse), json_schema_input_type=float | str)
    ] = Field(description="the part of the time at most, or adaptive: it follows the channel", examples=["40 %"])
    floor: Fraction | None = Field(
        default=None, description="what an adaptive limit never falls below; 0.2 % of the ceiling unless it is given"
    )
    ceiling: Fraction | None = Field(
        default=None, description="the most that the channel can carry at its best; an adaptive limit needs it"
    )
    window: Duration = Field(default=WINDOW, description="the limit holds in every window of this length")
    rate: Rate = Field(description="of the radio (PHY), between robots as they usually are apart")
    wifi: Wifi = Field(
        default="adhoc",
        description="infrastructure: through an access point, so everything is sent twice; adhoc; wired",
    )
    cast: Cast = Field(default="unicast", description="unicast: a copy for each receiver; multicast: one for all")
    multicast_rate: Rate = Field(
        default=BASIC_RATE,
        description="the rate of multicast; 1 Mbit/s, the lowest basic rate, unless the driver is set otherwise",
    )
    hops: int = Field(default=1, ge=1, le=32, description="how often a message is sent on until it arrives")
    overhead: Duration | None = Field(default=None, description="time on the air of each frame besides its bits")

    def measure(self) -> Measure:
        """Return the planner's measure, as for throughput; a wire has no overhead unless one is set."""
        default = 0.0 if self.wifi == "wired" else OVERHEAD
        return Airtime(
            fraction=self.most,
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
    name: Name | None = Field(
        default=None, description="what messages and the status call it; its kind unless it is given"
    )
    limit: Joule = Field(description="what each robot's own messages may take in any window")
    window: Duration = Field(default=WINDOW, description="the limit holds in every window of this length")
    per_byte: Joule | None = Field(default=None, description="what every byte of every copy takes")
    per_message: Joule | None = Field(default=None, description="what every copy takes besides its bytes")

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
