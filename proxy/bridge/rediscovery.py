"""Looks for robots that were lost sooner than Zenoh does, so that a link that is back is used at once.

Zenoh asks by multicast who is there, first after a second, in the end every eight seconds. While a robot is missing the
same question is asked more often, from Zenoh's own socket: then it is Zenoh that gets the answers, and connects.

No question reaches a robot that is several hops away, which was known by what those between told, and they tell only
news. So whoever had dialled a robot answers Zenoh's question in its place, with the address that was dialled.
"""

import os
import socket
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import zenoh

from proxy.bridge.sockets import links_of
from proxy.bridge.tuning import TUNING

_PEERS_WANTED = b"\x01\x09\x02"
"""A scout message of Zenoh's protocol: its kind, the version of the protocol, and who shall answer."""
_HERE, _VERSION, _PEER = 0x22, 9, 1
"""What an answer to it begins with: its kind, with addresses, the version, and that it is of a peer."""


class Rediscovery:
    """Asks while somebody is missing, with the scouting `sockets` of `session`, at the address of `options`."""

    def __init__(self, session: zenoh.Session, options: Mapping[str, Any], sockets: list[socket.socket]) -> None:
        host, _, port = options["scouting"]["multicast"]["address"].rpartition(":")
        self._session = session
        self._group = host, int(port)
        self._sockets = sockets
        self._linked: frozenset[str] = frozenset()
        self._lost: dict[str, float] = {}
        """Until when each robot is looked for that was linked [s]."""
        self._next = 0.0
        self._ports = {endpoint.split("#")[0].rpartition(":")[2] for endpoint in options["listen"]["endpoints"]}
        self._dialled: dict[str, str] = {}
        """Where each robot was dialled that is linked, or is looked for."""

    def check(self, now: float) -> None:
        """See who has gone and who is back, and ask if it is time."""
        linked = frozenset(str(zid) for zid in self._session.info.peers_zid())
        if linked != self._linked:
            self._lost |= dict.fromkeys(self._linked - linked, now + TUNING.rediscovery_time)
            self._linked = linked
            self._note_dialled()
        self._lost = {zid: until for zid, until in self._lost.items() if until > now and zid not in linked}
        if self._lost and now >= self._next:
            self._next = now + TUNING.rediscovery_interval * (1 + len(linked))
            for each in self._sockets:
                with suppress(OSError):  # the radio is off
                    each.sendto(_PEERS_WANTED, self._group)
            self._answer()

    def _note_dialled(self) -> None:
        """Take note of where the robots are that were dialled, and forget those that nobody looks for any more."""
        here = [link for link in links_of(self._session) if link.src.rpartition(":")[2] not in self._ports]
        known = self._dialled | {str(link.zid): link.dst for link in here}
        self._dialled = {zid: place for zid, place in known.items() if zid in self._linked or zid in self._lost}

    def _answer(self) -> None:
        """Tell Zenoh where the robots were that are lost."""
        for zid in self._lost.keys() & self._dialled.keys():
            for each in self._sockets:
                with suppress(OSError):
                    each.sendto(answer(zid, self._dialled[zid]), ("127.0.0.1", each.getsockname()[1]))

    def close(self) -> None:
        """Ask no more."""
        for each in self._sockets:
            each.close()


def answer(zid: str, place: str) -> bytes:
    """Return the answer to a scout message by which a robot would say that it listens at a place."""
    raw = bytes.fromhex(zid.zfill(len(zid) + len(zid) % 2))[::-1]
    return bytes([_HERE, _VERSION, (len(raw) - 1) << 4 | _PEER]) + raw + bytes([1, len(place)]) + place.encode()


def opened(open_session: Callable[[], zenoh.Session]) -> tuple[zenoh.Session, list[socket.socket]]:
    """Open a session; return it with the sockets that it scouts with. They are ours to close, too."""
    before = _sockets()
    session = open_session()
    found = []
    for name, number in _sockets().items():
        if name in before:
            continue
        with suppress(OSError):  # closed meanwhile
            each = socket.socket(fileno=os.dup(number))
            if _scouts(each):
                found.append(each)
            else:
                each.close()
    return session, found


def _scouts(candidate: socket.socket) -> bool:
    """Whether Zenoh asks from this socket: one for datagrams with a port, on no address of its own."""
    if candidate.family != socket.AF_INET or candidate.type != socket.SOCK_DGRAM:
        return False
    host, port = map(str, candidate.getsockname())
    return host == "0.0.0.0" and port != "0"  # noqa: S104 - it is compared, nothing binds to it


def _sockets() -> dict[str, int]:
    """Return the numbers of this process's open sockets by their names, which are not given anew as numbers are."""
    found = {}
    for entry in Path("/proc/self/fd").iterdir():
        with suppress(OSError):  # closed meanwhile
            name = str(entry.readlink())
            if name.startswith("socket:"):
                found[name] = int(entry.name)
    return found
