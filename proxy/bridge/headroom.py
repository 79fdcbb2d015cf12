"""How much the links of a session take before a publication has to wait.

Zenoh does not say when a link is full: a publication then waits, or is dropped. The kernel knows what waits in the
socket of each link; while that is little, a publication returns at once, whatever becomes of the radio.
"""

import ctypes
import fcntl
import ipaddress
import socket
import struct
import sys
import termios
import threading
from contextlib import suppress
from pathlib import Path

import zenoh

from proxy.bridge.air import Air

_libc = ctypes.PyDLL(None)
"""What is asked here answers at once: other threads need not be let in meanwhile, and out again."""
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
_TCP_INFO = 168
"""So much of it is needed [B]."""
LATELY = 300
"""A link that sent nothing for so long says nothing of the channel [ms]; it says that it is alive every 500 ms."""
DENSE = 4
"""With fewer segments on their way a round trip is longer than the way: receivers wait before they acknowledge."""
USABLE = 0.5
"""Part of a send buffer that is filled without asking again."""
LITTLE = 16384
"""With less room than this a link counts as slow [B]."""
EACH = 2048
"""What a small sample may take of a send buffer beside its bytes, in the worst case [B]."""

Address = tuple[str, int]


class Headroom:
    """Watches the sockets of all links of `session`. One that cannot be found counts as full."""

    def __init__(self, session: Air) -> None:
        self._session = session
        self._lock = threading.Lock()
        self._links: tuple[str, ...] = ()
        self._sockets: tuple[int, ...] = ()
        self._ends: tuple[tuple[str, int], ...] = ()
        """The session at the other end of each link, and its socket."""
        self._unknown = True
        self._budget = 0.0
        self.refresh()

    def takes(self, size: int) -> bool:
        """Whether a publication of `size` bytes surely does not wait; what it takes is accounted for."""
        cost = size + EACH
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
        return sum(room < LITTLE for room in rooms), len(rooms)

    def waits(self) -> tuple[tuple[str, float], ...]:
        """Return for each link that sends: the session at its other end, and when what is sent now arrives [s]."""
        waits = ((zid, _wait(number)) for zid, number in self._ends)
        return tuple((zid, wait) for zid, wait in waits if wait is not None)

    def sent(self) -> dict[str, int]:
        """Return for each link that has room: the session at its other end, and what Zenoh wrote so far [B]."""
        found = {zid: _written(number) for zid, number in self._ends if _room(number) >= LITTLE}
        return {zid: written for zid, written in found.items() if written is not None}

    @property
    def alone(self) -> bool:
        """Whether no link could be held up by another one."""
        return len(self._sockets) <= 1

    @property
    def clear(self) -> bool:
        """Whether no link has little room, as far as all of them can be seen."""
        return not self._unknown and not self.slow()[0]

    def refresh(self) -> None:
        """Take note of links that came and went."""
        ends = {f"{link.src} {link.dst}": str(link.zid) for link in self._session.info.links() if not _private(link)}
        links = tuple(sorted(ends))
        if links == self._links and not self._unknown:
            return
        found = _sockets()
        numbers = [found.get(tuple(_address(end) for end in link.split())) for link in links]  # type: ignore[arg-type]
        with self._lock:
            self._links = links
            self._sockets = tuple(number for number in numbers if number is not None)
            self._ends = tuple((ends[link], n) for link, n in zip(links, numbers, strict=True) if n is not None)
            self._unknown = None in numbers
            self._budget = 0.0

    def _look(self) -> float:
        if self._unknown:
            return 0.0
        return min((_room(number) for number in self._sockets), default=float("inf"))


def _private(link: zenoh.Link) -> bool:
    """Whether this is the link of our own voice."""
    return str(link.src).startswith("unixsock-stream")


def _room(number: int) -> float:
    """Return what may be written into a socket without asking again [B]; nothing when it is gone."""
    info = _Memory()
    if _libc.getsockopt(number, socket.SOL_SOCKET, _MEMINFO, info, ctypes.byref(ctypes.c_uint32(_MEMORY_SIZE))) != 0:
        return 0.0
    return USABLE * info[_SNDBUF] - max(info[_QUEUED], info[_ALLOCATED])


def _tcp_info(number: int) -> ctypes.Array[ctypes.c_char] | None:
    """Return what the kernel knows of a connection; None when it is gone or the kernel is too old."""
    info = ctypes.create_string_buffer(_TCP_INFO)
    size = ctypes.c_uint32(_TCP_INFO)
    failed = _libc.getsockopt(number, socket.IPPROTO_TCP, socket.TCP_INFO, info, ctypes.byref(size))
    return None if failed or size.value < _TCP_INFO else info


def _written(number: int) -> int | None:
    """Return what was written into a socket so far [B]; None when it is gone."""
    info = _tcp_info(number)
    if info is None:
        return None
    try:
        queued = fcntl.ioctl(number, termios.TIOCOUTQ, bytes(4))
    except OSError:
        return None
    return int(_ACKED.unpack_from(info)[0]) + int.from_bytes(queued, sys.byteorder)


def _wait(number: int) -> float | None:
    """Return how long what is written into a socket now is on its way [s]; None when nothing was sent lately."""
    info = _tcp_info(number)
    if info is None:
        return None
    since, unacked, rtt, not_sent, least, rate = (
        place.unpack_from(info)[0] for place in (_SINCE_SENT, _UNACKED, _RTT, _NOT_SENT, _LEAST_RTT, _RATE)
    )
    if since > LATELY or not rate:
        return None
    return float((rtt if unacked >= DENSE else least) / 1e6 + not_sent / rate)


def _sockets() -> dict[tuple[Address, Address], int]:
    """Return the numbers of this process's open TCP sockets by their two ends."""
    found = {}
    for entry in Path("/proc/self/fd").iterdir():
        with suppress(OSError):  # closed meanwhile, or not connected
            if not str(entry.readlink()).startswith("socket:"):
                continue
            borrowed = socket.socket(fileno=int(entry.name))
            try:
                if borrowed.family in (socket.AF_INET, socket.AF_INET6):
                    ends = _plain(borrowed.getsockname()), _plain(borrowed.getpeername())
                    found[ends] = borrowed.fileno()
            finally:
                borrowed.detach()  # it is Zenoh's
    return found


def _address(locator: str) -> Address:
    """Return the address in a locator such as `tcp/[::1]:7447`."""
    host, _, port = locator.partition("/")[2].split("#")[0].split("?")[0].rpartition(":")
    return _plain((host.strip("[]").split("%")[0], port))


def _plain(name: tuple[str, int | str] | tuple[str, int, int, int]) -> Address:
    """Return an address without what differs between how Zenoh and the kernel write it."""
    try:
        host = ipaddress.ip_address(name[0].split("%")[0])
    except ValueError:
        return name[0], 0
    mapped = host.ipv4_mapped if isinstance(host, ipaddress.IPv6Address) else None
    return str(mapped or host), int(name[1] or 0)
