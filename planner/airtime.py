"""Airtime: how long a message occupies the channel, whoever sends it.

A message is cut into frames, each of which costs the time of getting the channel and the time of its bits. The
defaults are those of 802.11 at 5 GHz (OFDM PHY, IEEE 802.11-2016, clause 17: slot 9 µs, SIFS 16 µs, CWmin 15, preamble
and SIGNAL 20 µs, symbols of 4 µs) carrying Zenoh over TCP:

    DIFS (SIFS + 2 slots)                                      34 µs
    mean backoff (7.5 slots)                                   67.5 µs
    preamble and SIGNAL                                        20 µs
    SIFS and ACK (14 B at 24 Mbit/s: 20 µs + 2 symbols)        44 µs
    half a frame with a TCP acknowledgement, one per two       about 90 µs

Together about 250 µs a frame. 802.11b with long preambles takes about 800 µs without the acknowledgement. Bytes around
the payload of each frame: MAC header, FCS, LLC/SNAP 38, IPv4 20, TCP with timestamps 32; around each message: Zenoh 24.
On a wire, Ethernet's preamble, header, FCS and gap are 38 B as well, and the channel costs nothing to get.
"""

import math
from dataclasses import dataclass
from typing import ClassVar, Literal, get_args

from planner.errors import ProblemError
from planner.finite import finite
from planner.measures import WINDOW, Windowed, check_positive

OVERHEAD = 250e-6
"""Time that a frame needs besides its bits, where the channel is the air [s]."""
FRAME_HEADERS = 90
"""Bytes around what a frame carries."""
FRAME_CARRIES = 1448
"""Bytes of a message that fit into a frame: an MTU of 1500 B less IPv4 and TCP with timestamps."""
MESSAGE_HEADERS = 24
"""Bytes that Zenoh puts around a message."""
BASIC_RATE = 125_000.0
"""The lowest basic rate of 802.11 at 2.4 GHz, 1 Mbit/s [B/s]: what multicast goes at unless it is configured."""

Wifi = Literal["adhoc", "infrastructure", "wired"]
"""Robots hear each other; they talk through an access point; they share a wire."""
Cast = Literal["unicast", "multicast"]
"""A transmission for each receiver, acknowledged; one for all of them."""


@dataclass(frozen=True, slots=True)
class Airtime(Windowed):
    """At most this `fraction` of any `window` [s] may the channel be occupied. Raises ProblemError.

    Unicast frames go at the `phy_rate` [B/s], and through an access point they cross the air twice. Multicast frames
    go at the `multicast_rate` [B/s], one for all receivers; through an access point once up at the PHY rate and once
    down at the multicast rate. All is repeated on each of `hops`. `overhead` is the time a frame needs besides its
    bits [s].
    """

    kind: ClassVar[str] = "airtime"
    unit: ClassVar[str] = "s"
    private: ClassVar[bool] = False

    fraction: float
    phy_rate: float
    window: float = WINDOW
    wifi: Wifi = "adhoc"
    cast: Cast = "unicast"
    multicast_rate: float = BASIC_RATE
    hops: int = 1
    overhead: float = OVERHEAD

    def __post_init__(self) -> None:
        check_positive(
            self.kind,
            fraction=self.fraction,
            phy_rate=self.phy_rate,
            window=self.window,
            multicast_rate=self.multicast_rate,
            hops=self.hops,
        )
        if self.fraction > 1.0:
            raise ProblemError(f"airtime: fraction must be at most 1, not {self.fraction}")
        if not (finite(self.overhead) and self.overhead >= 0.0):
            raise ProblemError(f"airtime: overhead must be a finite number >= 0, not {self.overhead}")
        for name, word, known in (("wifi", self.wifi, get_args(Wifi)), ("cast", self.cast, get_args(Cast))):
            if word not in known:
                raise ProblemError(f"airtime: {name} must be one of {', '.join(known)}, not {word!r}")

    @property
    def limit(self) -> float:
        """Time that the channel may be occupied in any window [s]."""
        return self.fraction * self.window

    @property
    def pace(self) -> float:
        """What frames without any overhead would carry [B/s]."""
        return self.fraction / (self.hops * self._per_byte)

    def use(self, size: int, copies: int, *, own: bool) -> float:  # noqa: ARG002 - the air is everybody's
        """Time that all transmissions of the message take together [s]."""
        size += MESSAGE_HEADERS
        frames = math.ceil(size / FRAME_CARRIES)
        size += frames * FRAME_HEADERS
        sent = copies if self.cast == "unicast" else 1
        return self.hops * sent * (self._crossings * frames * self.overhead + size * self._per_byte)

    @property
    def _crossings(self) -> int:
        """How often one transmission gets the channel."""
        return 2 if self.wifi == "infrastructure" else 1

    @property
    def _per_byte(self) -> float:
        """Time that a byte of one transmission takes, in all its crossings [s]."""
        if self.wifi == "wired":
            return 1.0 / self.phy_rate
        last = self.phy_rate if self.cast == "unicast" else self.multicast_rate
        return 1.0 / last + (1.0 / self.phy_rate if self.wifi == "infrastructure" else 0.0)
