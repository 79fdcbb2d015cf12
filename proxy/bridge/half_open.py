"""Links over which a transport outlived its connection: they are ended, so that both robots meet anew.

A robot may take a link for lost when the other one does not yet: the connection is half open. Who has lost it dials
again and begins with nothing; Zenoh 1.10 at the other end adds the new link to the transport that it still has, and
tells nothing of what it declared before. When the old link ends at last, both are linked for good, and one knows
neither tokens nor subscribers of the other. Seen from the end that kept its transport: a link goes and the transport
stays, although robots have but one link each way. Where two dial each other at once, both transports have both links
from the beginning: one of these that ends soon is no sign.
"""

import logging
import math
import threading

import zenoh

from proxy import clock
from proxy.bridge.declaration import Declaration
from proxy.bridge.sockets import Sockets
from proxy.bridge.tuning import TUNING

log = logging.getLogger(__name__)


class HalfOpen:
    """Ends such links of `session`; a link that lasted less than `young` [s] says nothing."""

    def __init__(self, session: zenoh.Session, young: float = TUNING.young_link) -> None:
        self._young = young
        self._sockets = Sockets(session)
        self._lock = threading.Lock()
        self._lost: dict[str, bool] = {}
        """Who lost a link since its transport was made or ended, and whether that was known at the last look."""
        self._since: dict[tuple[str, str], float] = {}
        """When each link began that we saw begin [s]."""
        events, links = session.info.declare_transport_events_listener, session.info.declare_link_events_listener
        self._listeners: tuple[Declaration, ...] = (
            events(zenoh.handlers.Callback(self._turn, indirect=False)),
            links(zenoh.handlers.Callback(self._change, indirect=False)),
        )

    def check(self, now: float) -> None:  # noqa: ARG002 - as all that looks at links is called
        """Look at who lost a link: a transport that ends with it has ended by the second look."""
        with self._lock:
            outlived = [zid for zid, seen in self._lost.items() if seen]
            self._lost = {zid: True for zid, seen in self._lost.items() if not seen}
        if outlived:
            self._end(outlived)

    def close(self) -> None:
        """Hear no more of links and transports."""
        for each in self._listeners:
            each.undeclare()
        self._listeners = ()

    def _end(self, outlived: list[str]) -> None:
        self._sockets.refresh()
        for zid, number in self._sockets.ends:
            if zid in outlived and self._sockets.end(number):
                log.info("%s may have met us anew over a link that was half open: it is ended", zid)

    def _turn(self, event: zenoh.TransportEvent) -> None:
        with self._lock:
            self._lost.pop(str(event.transport.zid), None)

    def _change(self, event: zenoh.LinkEvent) -> None:
        now, link = clock.monotonic(), event.link
        with self._lock:
            if event.kind == zenoh.SampleKind.PUT:
                self._since[link.src, link.dst] = now
            elif now - self._since.pop((link.src, link.dst), -math.inf) >= self._young:
                self._lost.setdefault(str(link.zid), False)
