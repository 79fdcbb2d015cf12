"""The sockets of a session's links: Zenoh says which links there are, the kernel knows what becomes of each."""

import ctypes
import ipaddress
import math
import socket
from contextlib import suppress
from pathlib import Path

import zenoh

from proxy import clock
from proxy.bridge.broadcast import Broadcast, DataSession
from proxy.bridge.tuning import TUNING

libc = ctypes.PyDLL(None)
"""What is asked here answers at once: other threads need not be let in meanwhile, and out again."""
_TCP_INFO = 168
"""So much of `tcp_info` of <linux/tcp.h> is needed [B]."""
_TcpInfo = ctypes.c_char * _TCP_INFO

Address = tuple[str, int]


class Sockets:
    """The TCP sockets of all links of `session`, but those of our own mirror session.

    Zenoh tells of links that come and go; of a broadcast session, which is opened anew now and then, it is asked.
    """

    def __init__(self, session: DataSession) -> None:
        self._session = session
        self._told = False
        """Whether links came or went since they were listed."""
        self._next = -math.inf
        """When they are listed in any case [s]."""
        if not isinstance(session, Broadcast):
            handler = zenoh.handlers.Callback(self._note, indirect=False)
            self._listener = session.info.declare_link_events_listener(handler)
        self._links: tuple[str, ...] = ()
        self.ends: tuple[tuple[str, int], ...] = ()
        """The session at the other end of each link, and its socket."""
        self._places: dict[int, tuple[Address, Address]] = {}
        self.unknown = True
        """Whether the sockets of some links cannot be found."""

    def refresh(self) -> bool:
        """Take note of links that came and went; whether there may be news."""
        now = clock.monotonic()
        if not (self._told or self.unknown or now >= self._next or isinstance(self._session, Broadcast)):
            return False
        self._told, self._next = False, now + TUNING.links_listed
        ends = {f"{link.src} {link.dst}": str(link.zid) for link in links_of(self._session)}
        links = tuple(sorted(ends))
        if links == self._links and not self.unknown:
            return False
        found = _sockets()
        places = [_place(link) for link in links]
        numbers = [found.get(place) for place in places]
        self._places = {number: place for number, place in zip(numbers, places, strict=True) if number is not None}
        self._links = links
        self.ends = tuple((ends[link], n) for link, n in zip(links, numbers, strict=True) if n is not None)
        self.unknown = None in numbers
        return True

    def end(self, number: int) -> bool:
        """End the link that a socket was found for; whether it still is its socket, as numbers are used again."""
        owns = number in self._places and _sockets().get(self._places[number]) == number
        if owns:
            libc.shutdown(number, socket.SHUT_RDWR)
        return owns

    def _note(self, _: zenoh.LinkEvent) -> None:
        self._told = True


def tcp_info(number: int) -> ctypes.Array[ctypes.c_char] | None:
    """Return what the kernel knows of a connection; None when it is gone or the kernel is too old."""
    info = _TcpInfo()
    size = ctypes.c_uint32(_TCP_INFO)
    failed = libc.getsockopt(number, socket.IPPROTO_TCP, socket.TCP_INFO, info, ctypes.byref(size))
    return None if failed or size.value < _TCP_INFO else info


def links_of(session: DataSession) -> list[zenoh.Link]:
    """Return the links of a session to other nodes: all but that of our own mirror session."""
    return [link for link in session.info.links() if not link.src.startswith("unixsock-stream")]


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


def _place(link: str) -> tuple[Address, Address]:
    """Return the two ends of a link."""
    near, far = link.split()
    return _address(near), _address(far)


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
