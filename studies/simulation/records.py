"""What goes into a flight, and what comes out."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True)
class Frame:
    """A sample that an app will publish: `t_gen` is true time [s], `size` in bytes."""

    robot: str
    key: str
    t_gen: float
    size: int
    features: dict[str, float]


@dataclass(frozen=True, slots=True)
class Delivery:
    """A frame that was sent to a receiver who wants it, and when it arrived there (None: lost)."""

    frame: Frame
    t_sent: float
    t_rcv: float | None
    receiver: str = ""


@dataclass(frozen=True, slots=True)
class OnAir:
    """Bytes put on the air, all copies together; `frame` is None for what robots tell each other."""

    t: float
    robot: str
    size: int
    frame: Frame | None = None
    digest: bool = False


class Flown(Protocol):
    """A flight as scores see it, whoever decided: what came to each receiver, and what was put on the air."""

    @property
    def deliveries(self) -> Sequence[Delivery]:
        """What was sent, by receiver."""

    @property
    def on_air(self) -> Sequence[OnAir]:
        """What was sent, all copies together."""
