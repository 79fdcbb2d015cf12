"""The socket in which a session hears a multicast group.

Zenoh's receiver ends for good at the first datagram that it cannot decode, from whomever, and closes its socket.
Without a look at that a team is deaf until it misses everybody: one stray byte kept all samples from everybody for
2.3 s, and such a byte every 1.5 s for as long as they came.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

_TABLES = ("/proc/self/net/udp", "/proc/self/net/udp6")


class GroupSockets:
    """The sockets in which the session opened last hears `group`."""

    def __init__(self, group: str) -> None:
        self._group = group
        self._ever_found = False
        self._sockets: frozenset[tuple[int, int]] | None = None
        """None where that cannot be told."""

    @contextmanager
    def found(self) -> Iterator[None]:
        """Find those that are opened within."""
        self._sockets, before = None, sockets_on(self._group)
        yield
        sockets = sockets_on(self._group) - before
        self._ever_found |= bool(sockets)
        if self._ever_found:
            self._sockets = sockets

    @property
    def closed(self) -> bool:
        """Whether the session hears nothing more; without a socket it was deafened before one could be found."""
        if self._sockets is None:
            return False
        return not (self._sockets and all(is_open(*each) for each in self._sockets))


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


def is_open(descriptor: int, inode: int) -> bool:
    """Whether a socket is still there."""
    try:
        return os.fstat(descriptor).st_ino == inode
    except OSError:
        return False


def _rows(table: str) -> list[str]:
    try:
        return Path(table).read_text().splitlines()[1:]
    except OSError:  # a kernel without IPv6
        return []
