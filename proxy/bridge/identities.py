"""Whether the robot that a presence token says to be there can be the one at the other end of a link.

Access control lets a robot show presence tokens of its own name alone, but not of its own session alone: one that shows
another one's session under its name would have all others take that one's digests for forged. The certificate of the
link tells. And where robots are linked each to each a token without a link is of nobody: hundreds of them, for each of
whom a copy might be wanted, would take all room.
"""

import math
from collections.abc import Collection, Mapping
from typing import Any

import zenoh

from proxy import clock
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.sockets import links_of


class Identities:
    """Knows the links of `session`; `names` are those that certificates vouch for."""

    def __init__(self, session: zenoh.Session, names: Collection[str]) -> None:
        self._session = session
        self._names = frozenset(names)
        self._linked: frozenset[str] = frozenset()
        """The sessions at the other ends of all links..."""
        self._routed = False
        """... and whether one of them is a router, behind which others may be..."""
        self._turned, self._listed = True, -math.inf
        """... whether any came or went since these were listed, and when that was [s]."""
        self._met: set[str] = set()
        """The sessions as Zenoh tells of each link that comes and goes."""
        events = session.info.declare_transport_events_listener
        self._listener = events(zenoh.handlers.Callback(self._turn, indirect=False), history=True)

    def forged(self, robot: str, zid: str) -> bool:
        """Whether a token says that the session `zid` is of `robot`, and the certificate of its link another name.

        A robot without a link of its own, behind a router, nobody vouches for.
        """
        name = robot.removesuffix(f"-{zid[:4]}")
        if name not in self._names:
            return False
        vouched = {link.auth_identifier for link in links_of(self._session) if str(link.zid) == zid} - {None}
        return bool(vouched) and name not in vouched

    def absent(self, zid: str) -> bool:
        """Whether there is no link to the session `zid`, and no router behind which it may be."""
        now = clock.monotonic()
        if zid not in self._linked and (self._turned or now >= self._listed + BOUNDS.links_listed):
            self._turned, self._listed = False, now
            self._linked = frozenset(str(link.zid) for link in links_of(self._session))
            self._routed = bool(self._session.info.routers_zid())
        return zid not in self._linked and not self._routed

    def strange(self, zid: str) -> bool:
        """Whether there seems to be no link to the session `zid`, at once and from any thread.

        News of one may be on its way; whoever is behind a router has none.
        """
        return zid not in self._met

    def _turn(self, event: zenoh.TransportEvent) -> None:
        self._turned = True
        turn = self._met.add if event.kind == zenoh.SampleKind.PUT else self._met.discard
        turn(str(event.transport.zid))


def certified_names(zenoh_options: Mapping[str, Any]) -> frozenset[str]:
    """Return the names of certificates that the access control of a session has rules for."""
    control = zenoh_options.get("access_control", {})
    if not control.get("enabled"):
        return frozenset()
    return frozenset(name for each in control.get("subjects") or () for name in each.get("cert_common_names") or ())
