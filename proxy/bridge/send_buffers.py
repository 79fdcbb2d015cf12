"""How much the links of a session take before a publication has to wait.

Zenoh does not say when a link is full: a publication then waits, or is dropped. The kernel knows what waits in the
socket of each link; while that is little, a publication returns at once, whatever becomes of the radio.
"""

import ctypes
import fcntl
import math
import socket
import struct
import sys
import termios
import threading

from proxy.bridge.broadcast import Broadcast, DataSession
from proxy.bridge.sockets import Sockets, libc, tcp_info
from proxy.bridge.tuning import TUNING

_Memory = ctypes.c_uint32 * 9
_MEMORY_SIZE = ctypes.sizeof(_Memory)
_MEMINFO = 55
"""SO_MEMINFO of <asm-generic/socket.h>."""
_SNDBUF, _QUEUED, _ALLOCATED = 3, 5, 2
"""Places in what it gives: size of the send buffer, memory queued to be sent (TCP), memory being sent (UDP)."""
_SINCE_SENT, _UNACKED, _RTT, _NOT_SENT, _LEAST_RTT, _RATE = (
    struct.Struct(f"@{at}x{kind}") for at, kind in ((44, "I"), (24, "I"), (68, "I"), (144, "I"), (148, "I"), (160, "Q"))
)
"""Places in `tcp_info` of <linux/tcp.h>: time since something was sent [ms], segments on their way, the time of a round
trip [us], bytes that wait, the least time of a round trip [us], and what came through at last [B/s]."""
_ACKED = struct.Struct("@120xQ")
"""Place of the bytes that have arrived."""


class SendBuffers:
    """Watches the sockets of all links of `session`. One that cannot be found counts as full."""

    def __init__(self, session: DataSession) -> None:
        self._found = Sockets(session)
        self._broadcasts = isinstance(session, Broadcast)
        self._lock = threading.Lock()
        self._sockets: tuple[int, ...] = ()
        self._ends: tuple[tuple[str, int], ...] = ()
        """The session at the other end of each link, and its socket."""
        self._unknown = True
        self._budget = 0.0
        self.refresh()

    def takes(self, size: int) -> bool:
        """Whether a publication of `size` bytes surely does not wait; what it takes is accounted for."""
        cost = size + TUNING.sample_overhead
        with self._lock:
            if self._budget < cost:
                self._budget = self._look()
            if self._budget < cost:
                return False
            self._budget -= cost
            return True

    def slow(self) -> tuple[int, int]:
        """Return how many links have little room, and how many there are."""
        rooms = [_room(number) for number in self._sockets]
        return sum(room < TUNING.little_room for room in rooms), len(rooms)

    def waits(self) -> tuple[tuple[str, float], ...]:
        """Return for each link that sends: the session at its other end, and when what is sent now arrives [s]."""
        waits = ((zid, _wait(number)) for zid, number in self._ends)
        return tuple((zid, wait) for zid, wait in waits if wait is not None)

    def sent(self) -> dict[str, int]:
        """Return for each link that has room: the session at its other end, and what Zenoh wrote so far [B]."""
        found = {zid: _written(number) for zid, number in self._ends if _room(number) >= TUNING.little_room}
        return {zid: written for zid, written in found.items() if written is not None}

    @property
    def alone(self) -> bool:
        """Whether no link could be held up by another one."""
        return len(self._sockets) <= 1

    @property
    def clear(self) -> bool:
        """Whether no link has little room, as far as all of them can be seen."""
        return not self._unknown and not self.slow()[0]

    @property
    def idle(self) -> bool:
        """Whether no link holds anything to speak of: what was published has left.

        Of what is broadcast nobody knows, for nobody acknowledges it.
        """
        if self._unknown or self._broadcasts:
            return False
        return all(_buffer(number)[1] <= TUNING.idle_buffer for number in self._sockets)

    def refresh(self) -> None:
        """Take note of links that came and went."""
        if not self._found.refresh():
            return
        ends = self._found.ends
        with self._lock:
            self._sockets = tuple(number for _, number in ends)
            self._ends = ends
            self._unknown = self._found.unknown
            self._budget = 0.0

    def _look(self) -> float:
        if self._unknown:
            return 0.0
        return min((_room(number) for number in self._sockets), default=float("inf"))


def _room(number: int) -> float:
    """Return what may be written into a socket without asking again [B]; nothing when it is gone."""
    size, held = _buffer(number)
    return TUNING.usable_buffer * size - held


def _buffer(number: int) -> tuple[int, float]:
    """Return the size of a send buffer, and what it holds [B]; more than that when it is gone."""
    info = _Memory()
    if libc.getsockopt(number, socket.SOL_SOCKET, _MEMINFO, info, ctypes.byref(ctypes.c_uint32(_MEMORY_SIZE))) != 0:
        return 0, math.inf
    return info[_SNDBUF], max(info[_QUEUED], info[_ALLOCATED])


def _written(number: int) -> int | None:
    """Return what was written into a socket so far [B]; None when it is gone."""
    info = tcp_info(number)
    if info is None:
        return None
    try:
        queued = fcntl.ioctl(number, termios.TIOCOUTQ, bytes(4))
    except OSError:
        return None
    return int(_ACKED.unpack_from(info)[0]) + int.from_bytes(queued, sys.byteorder)


def _wait(number: int) -> float | None:
    """Return how long what is written into a socket now is on its way [s]; None when nothing was sent lately."""
    info = tcp_info(number)
    if info is None:
        return None
    since, unacked, rtt, not_sent, least, rate = (
        place.unpack_from(info)[0] for place in (_SINCE_SENT, _UNACKED, _RTT, _NOT_SENT, _LEAST_RTT, _RATE)
    )
    if since > TUNING.sent_lately or not rate:
        return None
    return float((rtt if unacked >= TUNING.dense_segments else least) / 1e6 + not_sent / rate)
