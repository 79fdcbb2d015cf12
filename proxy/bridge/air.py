"""The air: the session on which samples travel. In unicast the mesh session, in broadcast one of its own.

Broadcast is a Zenoh peer with nothing but a multicast endpoint: one transmission reaches every robot. Nothing is
acknowledged, repeated, encrypted or held back there, and Zenoh knows of nobody's subscriptions. So all else stays on
the mesh session: what daemons tell each other, queries, liveliness, and who wants what.
"""

import logging
import threading
from collections.abc import Callable
from typing import Any

import zenoh

from proxy import clock
from proxy.bridge.declaration import Declaration
from proxy.bridge.radio import interface_of
from proxy.bridge.sessions import AT_ONCE, reason_of, zenoh_session
from proxy.errors import SessionError

log = logging.getLogger(__name__)

JOIN = 1000
"""How often a robot says that it is on the group [ms]: a newcomer is heard this late at most. Costs 135 B/s."""
CHECK = 0.5
"""Time between two looks at who is heard [s]."""
PATIENCE = 2.5
"""The session is opened anew when nobody is heard for so long although there are others [s]; then twice that, …"""
MOST_PATIENCE = 60.0
"""… up to this [s]."""

Hear = Callable[[zenoh.Sample], None]


def broadcast_options(group: str, interface: str) -> dict[str, Any]:
    """Zenoh configuration of a session on a multicast group alone, with lanes for the priorities."""
    return {
        "mode": "peer",
        "listen": {"endpoints": [f"udp/{group}#iface={interface}"]},
        "connect": {"endpoints": []},
        "open": AT_ONCE,
        "scouting": {"delay": 0, "multicast": {"enabled": False}, "gossip": {"enabled": False}},
        "timestamping": {"enabled": False},
        "transport": {
            "shared_memory": {"enabled": False},
            # Without lanes every sample arrives with the default priority.
            "multicast": {"qos": {"enabled": True}, "join_interval": JOIN},
        },
    }


class Broadcast:
    """A session on a multicast group, opened anew when it died: Zenoh gives up on one whose radio was off.

    `others` says whether there is anybody to be heard. Raises `SessionError` when it cannot be opened.
    """

    def __init__(self, group: str, interface: str, others: Callable[[], bool]) -> None:
        self._group = group
        self._interface = interface
        self._others = others
        self._lock = threading.Lock()
        self._subscriptions: dict[_Subscription, None] = {}
        self._reopened = 0
        self._session = self._opened()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="broadcast", daemon=True)
        self._thread.start()

    def put(self, *arguments: Any, **options: Any) -> None:
        """Publish as `zenoh.Session.put` does."""
        self._session.put(*arguments, **options)

    def delete(self, *arguments: Any, **options: Any) -> None:
        """Delete as `zenoh.Session.delete` does."""
        self._session.delete(*arguments, **options)

    def declare_subscriber(self, expression: str, handler: Any, *, allowed_origin: zenoh.Locality) -> Declaration:
        """Subscribe as `zenoh.Session.declare_subscriber` does, in every session to come."""

        def declare(session: zenoh.Session) -> Declaration:
            return session.declare_subscriber(expression, handler, allowed_origin=allowed_origin)

        with self._lock:
            subscription = _Subscription(self._forget, declare)
            subscription.move(self._session)
            self._subscriptions[subscription] = None
        return subscription

    def close(self) -> None:
        """Leave the group."""
        self._stop.set()
        self._thread.join()
        self._session.close()  # type: ignore[no-untyped-call] # the stubs leave its type out

    def describe(self) -> dict[str, Any]:
        """Return what the status says: where, how many robots are heard there, how often it had to be opened anew."""
        return {
            "group": self._group,
            "interface": self._interface,
            "heard": self._heard(),
            "reopened": self._reopened,
        }

    def _heard(self) -> int:
        return len({str(link.zid) for link in self._session.info.links()})

    def _opened(self) -> zenoh.Session:
        try:
            interface = interface_of(self._interface)
            return zenoh_session(broadcast_options(self._group, interface))
        except zenoh.ZError as error:
            raise SessionError(
                f"mesh.interface {self._interface}, mesh.group {self._group}: cannot broadcast: "
                f"{reason_of(error).rpartition('[')[2]}"
            ) from error

    def _run(self) -> None:
        """Look whether anybody is heard; a dead session hears nobody."""
        patience, since = PATIENCE, clock.monotonic()
        while not self._stop.wait(CHECK):
            if self._heard() or not self._others():
                patience, since = PATIENCE, clock.monotonic()
            elif clock.monotonic() - since > patience:
                self._reopen()
                patience, since = min(2.0 * patience, MOST_PATIENCE), clock.monotonic()

    def _reopen(self) -> None:
        try:
            session = self._opened()
        except SessionError as error:
            log.warning("%s", error)
            return
        with self._lock:
            old, self._session = self._session, session
            for subscription in self._subscriptions:
                subscription.move(session)
        self._reopened += 1
        log.info("nobody is heard on %s: joined the group anew", self._group)
        old.close()  # type: ignore[no-untyped-call]

    def _forget(self, subscription: "_Subscription") -> None:
        with self._lock:
            self._subscriptions.pop(subscription, None)


class _Subscription:
    """A subscription that moves from session to session."""

    def __init__(
        self, forget: Callable[["_Subscription"], None], declare: Callable[[zenoh.Session], Declaration]
    ) -> None:
        self._forget = forget
        self._declare = declare
        self._declared: Declaration | None = None

    def move(self, session: zenoh.Session) -> None:
        """Be declared on `session` instead of where it was."""
        self._take_back()
        self._declared = self._declare(session)

    def undeclare(self) -> None:
        """Take it back for good."""
        self._forget(self)
        self._take_back()

    def _take_back(self) -> None:
        declared, self._declared = self._declared, None
        if declared is not None:
            declared.undeclare()


Air = zenoh.Session | Broadcast
"""Where samples travel."""
