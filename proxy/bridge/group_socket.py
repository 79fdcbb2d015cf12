"""The socket in which a session hears a multicast group.

Zenoh's receiver ends for good at the first datagram that it cannot decode, from whomever, and closes its socket.
Without a look at that a team is deaf until it misses everybody: one stray byte kept all samples from everybody for
2.3 s, and such a byte every 1.5 s for as long as they came.

The receiver ends with a panic, and keeps its socket, at a sample of a Zenoh node that has no lanes for priorities, as
none has by default: all were deaf for good. Then what comes is read no more.
"""

import ipaddress
import os
import socket
import struct
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from proxy.bridge.radio import index_of
from proxy.bridge.tuning import TUNING

_TABLES = ("/proc/self/net/udp", "/proc/self/net/udp6")
_MEMINFO, _MEMORY, _HELD = 55, 36, struct.Struct("@I")
"""SO_MEMINFO of <asm-generic/socket.h>, the size of what it gives, and its first number: what waits to be read [B]."""
_LOOPBACK = ("lo", "127.0.0.1", "::1")


class GroupSockets:
    """The sockets in which the session opened last hears `group`."""

    def __init__(self, group: str) -> None:
        self._group = group
        self._ever_found = False
        self._sockets: frozenset[tuple[int, int]] | None = None
        """None where that cannot be told."""
        self._unread = 0, 0
        """What waits to be read [B], and in how many looks none of it was."""

    @contextmanager
    def found(self) -> Iterator[None]:
        """Find those that are opened within."""
        self._sockets, self._unread, before = None, (0, 0), sockets_on(self._group)
        yield
        sockets = sockets_on(self._group) - before
        self._ever_found |= bool(sockets)
        if self._ever_found:
            self._sockets = sockets
        for descriptor, _ in sockets:
            _widen(descriptor)

    @property
    def closed(self) -> bool:
        """Whether the session hears nothing more; without a socket it was deafened before one could be found."""
        if self._sockets is None:
            return False
        return not (self._sockets and all(is_open(*each) for each in self._sockets))

    def stuck(self, looks: int, *, busy: bool) -> bool:
        """Whether nothing of what waits there was read in so many looks; while `busy` that means nothing.

        Nor does time: while a whole process stands still nobody reads, nor looks. What waits becomes less as it is
        read, at the latest when all of it is.
        """
        unread = sum(_unread(descriptor) for descriptor, _ in self._sockets or ())
        before, count = self._unread
        self._unread = unread, 0 if busy or not before or unread < before else count + 1
        return unread > 0 and self._unread[1] >= looks


def sockets_on(group: str) -> frozenset[tuple[int, int]]:
    """Return the sockets of this process on the port of `group`, by descriptor and inode."""
    port = f":{int(group.rpartition(':')[2]):04X}"
    inodes = {row.split()[9] for table in _TABLES for row in _rows(table) if row.split()[1].endswith(port)}
    found = set()
    for each in Path("/proc/self/fd").iterdir():
        with suppress(OSError):  # it was closed meanwhile
            inode = str(each.readlink()).removeprefix("socket:[").removesuffix("]")
            if inode in inodes:
                found.add((int(each.name), int(inode)))
    return frozenset(found)


def refusal(group: str, interface: str) -> str:
    """Say why this host sends nothing to `group` on `interface`; nothing if it does, or if nobody can tell.

    It is tried, with a datagram that nobody hears: it does not leave this host, nor come back to it but on loopback.
    """
    if interface in _LOOPBACK:
        return ""
    host, _, port = group.rpartition(":")
    try:
        address = ipaddress.ip_address(host.strip("[]"))
        if address.version == 4:
            return _refusal_v4(str(address), int(port), interface)
        return _refusal_v6(str(address), int(port), index_of(interface))
    except OSError as error:
        return error.strerror or str(error)


def is_open(descriptor: int, inode: int) -> bool:
    """Whether a socket is still there."""
    try:
        return os.fstat(descriptor).st_ino == inode
    except OSError:
        return False


@contextmanager
def _borrowed(descriptor: int) -> Iterator[socket.socket]:
    known = socket.socket(fileno=descriptor)
    try:
        yield known
    finally:
        known.detach()  # it is Zenoh's


def _unread(descriptor: int) -> int:
    try:
        with _borrowed(descriptor) as known:
            return int(_HELD.unpack_from(known.getsockopt(socket.SOL_SOCKET, _MEMINFO, _MEMORY))[0])
    except OSError:  # it was closed meanwhile
        return 0


def _widen(descriptor: int) -> None:
    """Let more wait there, as far as this host allows; Linux has twice of what is asked for."""
    with suppress(OSError), _borrowed(descriptor) as known:
        most = min(TUNING.group_buffer, int(Path("/proc/sys/net/core/rmem_max").read_text()))
        if known.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF) < 2 * most:
            known.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, most)


def _refusal_v4(host: str, port: int, interface: str) -> str:
    try:
        near, index = socket.inet_aton(interface), 0
    except OSError:
        near, index = bytes(4), socket.if_nametoindex(interface)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, bytes(4) + near + struct.pack("@i", index))
        probe.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        probe.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 0)
        probe.sendto(b"", (host, port))
    return ""


def _refusal_v6(host: str, port: int, index: int) -> str:
    with socket.socket(socket.AF_INET6, socket.SOCK_DGRAM) as probe:
        probe.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_MULTICAST_IF, index)
        probe.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_MULTICAST_HOPS, 0)
        probe.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_MULTICAST_LOOP, 0)
        probe.sendto(b"", (host, port, 0, index))
    return ""


def _rows(table: str) -> list[str]:
    try:
        return Path(table).read_text().splitlines()[1:]
    except OSError:  # a kernel without IPv6
        return []
