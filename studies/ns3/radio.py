"""ns-3's Wi-Fi as an object: robots by number, messages by number."""

import ctypes
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Literal, NamedTuple, Self

from studies.ns3.building import shim

BATCH = 256
"""Arrivals that are fetched at once."""
ALL = -1
"""Receives what is broadcast."""


class Arrival(NamedTuple):
    """Message `id` arrived at a robot, `at` [s]."""

    id: int
    receiver: int
    at: float


@dataclass(frozen=True, slots=True)
class Channel:
    """The channel of §4.2, or another one.

    `rate` is ns-3's name of the constant rate of all frames, broadcast ones included. `strength` is that of every
    signal where it is received [dBm]; whether a rate gets through at a strength is nearly yes or no, so what is lost is
    set by `loss`, the part of frames. With an `access_point` robots send by way of that, else directly (ad hoc).
    """

    standard: Literal["802.11b", "802.11g"] = "802.11b"
    rate: str = "DsssRate5_5Mbps"
    strength: float = -80.0
    loss: float = 0.0
    access_point: bool = False


AD_HOC = Channel()
"""That of the paper: 5.5 Mbit/s, ad hoc."""
INFRASTRUCTURE = Channel("802.11g", "ErpOfdmRate24Mbps", -70.0, access_point=True)
"""What most robots have: everything goes by way of an access point."""


class _Arrival(ctypes.Structure):
    _fields_: Sequence[tuple[str, type]] = [  # type: ignore[misc]
        ("id", ctypes.c_uint64),
        ("receiver", ctypes.c_int32),
        ("at", ctypes.c_double),
    ]


class Radio:
    """A channel with so many robots on it. One at a time in a process: ns-3 has one simulator.

    Times are seconds since it was opened. Raises Ns3Unavailable, RuntimeError where another one is open.
    """

    _open = False

    def __init__(self, robots: int, channel: Channel = AD_HOC, seed: int = 0) -> None:
        if Radio._open:
            raise RuntimeError("ns-3 simulates one channel at a time in a process: close the other one first")
        self._library = _declared(ctypes.CDLL(str(shim())))
        self._arrivals = (_Arrival * BATCH)()
        Radio._open = self._here = True
        self._library.radio_open(
            robots,
            channel.standard.encode(),
            channel.rate.encode(),
            channel.strength,
            channel.loss,
            channel.access_point,
            seed + 1,
        )

    def send(self, at: float, sender: int, receiver: int, size: int, number: int) -> None:
        """Have a robot send a message of `size` bytes at `at` [s] to another one, or to `ALL`."""
        self._library.radio_send(at, sender, receiver, size, number)

    def run(self, until: float) -> Iterator[Arrival]:
        """Go on until `until` [s] or until something arrives, and return what arrived at that time."""
        count = self._library.radio_run(until, self._arrivals, BATCH)
        for each in self._arrivals[:count]:
            yield Arrival(each.id, each.receiver, each.at)

    def close(self) -> None:
        """Forget the channel."""
        if self._here:
            Radio._open = self._here = False
            self._library.radio_close()

    def __enter__(self) -> Self:
        """Return it, to be closed at the end."""
        return self

    def __exit__(self, kind: type[BaseException] | None, fault: BaseException | None, at: TracebackType | None) -> None:
        """Close it."""
        self.close()


def _declared(library: ctypes.CDLL) -> ctypes.CDLL:
    """Say what the functions of the shim take and return."""
    text, number, real = ctypes.c_char_p, ctypes.c_int, ctypes.c_double
    library.radio_close.argtypes = []
    library.radio_open.argtypes = [number, text, text, real, real, number, ctypes.c_uint32]
    library.radio_send.argtypes = [real, number, number, ctypes.c_uint32, ctypes.c_uint64]
    library.radio_run.argtypes = [real, ctypes.POINTER(_Arrival), number]
    for void in (library.radio_close, library.radio_open, library.radio_send):
        void.restype = None
    return library
