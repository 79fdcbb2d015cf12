"""The session on which samples travel: in unicast the mesh session, in broadcast one of its own.

Broadcast is a Zenoh peer with nothing but a multicast endpoint: one transmission reaches every robot. Nothing is
acknowledged, repeated, encrypted or held back there, and Zenoh knows of nobody's subscriptions. So all else stays on
the mesh session: what daemons tell each other, queries, liveliness, who wants what, and the few samples whose keys have
verbatim chunks that no pattern of ours names, or are as long as Zenoh takes.

Where two nodes of a group declare the same key expression, Zenoh 1.10 lets them repeat each other's declaration without
end, and that takes all of the air. So no two robots may subscribe to the same: samples travel below a chunk that each
robot matches by a pattern of its own, and arrive under their own key.
"""

import logging
import re
import secrets
import threading
from collections.abc import Callable
from functools import partial
from typing import Any

import zenoh

from proxy import clock
from proxy.bridge.attached import attach
from proxy.bridge.declaration import Declaration
from proxy.bridge.group_socket import GroupSockets, refusal
from proxy.bridge.keys import ALL_DIGESTS, ANNOUNCED, INGRESS, ON_AIR, on_air
from proxy.bridge.keys import PREFIX as OWN
from proxy.bridge.radio import interface_of, only_link_local
from proxy.bridge.sessions import AT_ONCE, reason_of, zenoh_session
from proxy.bridge.tuning import TUNING
from proxy.errors import SessionError

log = logging.getLogger(__name__)

_STRAY = "something came that is not from a robot, and Zenoh heard nothing more"

Hear = Callable[[str, zenoh.Sample], None]
"""Gets a sample, and the key that it was published under."""


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
            "multicast": {"qos": {"enabled": True}, "join_interval": TUNING.join_interval},
        },
    }


class Broadcast:
    """A session on a multicast group, opened anew when it died: Zenoh gives up on one whose radio was off.

    `mesh` carries what cannot be broadcast. `others` says whether there is anybody to be heard. Raises `SessionError`
    when it cannot be opened.
    """

    def __init__(self, group: str, interface: str, mesh: zenoh.Session, others: Callable[[], bool]) -> None:
        self._group = group
        self._interface, self._radio = interface, ""
        self._mesh = mesh
        self._others = others
        self._hear: Hear = lambda _key, _sample: None
        self._attend: Hear | None = None
        self._subscribers: list[Declaration] = []
        self._reopened, self._deafened = 0, 0
        self._taking = set[int]()
        """Threads that are busy with a sample: Zenoh reads no further until then..."""
        self._taken, self._looked = 0, 0
        """... and how many samples they were busy with, by now and at the last look."""
        self._panicked: zenoh.Session | None = None
        """The session whose routes are lost."""
        self._left = ""
        """The id of the session that another one took the place of last: until it is closed both may hear the same."""
        self._silent = False
        """Whether nobody is heard although there are others, for a while already."""
        self._refusal = ""
        """Why this host sends nothing to the group."""
        self._sockets = GroupSockets(group)
        self._session = self._opened()
        self._joining = threading.Lock()
        """Held while the session, or who attends, becomes another one: else a new session lacks it, or has it twice."""
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="broadcast", daemon=True)
        self._thread.start()

    @property
    def info(self) -> zenoh.SessionInfo:
        """Return what Zenoh knows of the session in use."""
        return self._session.info

    def put(self, key: zenoh.KeyExpr | str, payload: Any, **options: Any) -> None:
        """Publish as `zenoh.Session.put` does."""
        if on_air(str(key)):
            self._broadcast(zenoh.Session.put, key, payload, **options)
        else:
            self._mesh.put(key, payload, **options)

    def delete(self, key: zenoh.KeyExpr | str, **options: Any) -> None:
        """Delete as `zenoh.Session.delete` does."""
        if on_air(str(key)):
            self._broadcast(zenoh.Session.delete, key, **options)
        else:
            self._mesh.delete(key, **options)

    def listen(self, hear: Hear) -> None:
        """Call `hear` with every sample of an app on another robot from now on."""
        self._hear = hear

    def attend(self, hear: Hear) -> None:
        """Call `hear` with every digest that another robot broadcasts from now on."""
        with self._joining:
            self._attend = hear
            self._subscribers.append(self._subscribed(self._session, ALL_DIGESTS))

    def announce(self, key: str, payload: bytes) -> None:
        """Broadcast a digest."""
        self._broadcast(zenoh.Session.put, key, payload, **ANNOUNCED)

    def close(self) -> None:
        """Leave the group."""
        self._stop.set()
        self._thread.join()
        _close(self._session)

    def warnings(self) -> list[str]:
        """Say that this host sends nothing, and that others than robots use the group."""
        found = []
        if self._refusal:
            found.append(f"nothing is sent to mesh.group {self._group}, nor heard: {self._refusal}")
        if self._deafened:
            times = f"{self._deafened} times samples were missed for a moment"
            found.append(f"what is no robot sends to mesh.group {self._group}: {times}; keep other programs out of it")
        return found

    def unheard(self, robots: int) -> list[str]:
        """Say that none of so many robots on the group is heard."""
        if not self._silent or not robots:
            return []
        cure = "let multicast through, at access points too, or set mesh.transport to unicast"
        return [f"no robot is heard on mesh.group {self._group}, of {robots} that broadcast there: {cure}"]

    def describe(self) -> dict[str, Any]:
        """Return what the status says: where, how many robots are heard there, how often it had to be opened anew."""
        return {
            "group": self._group,
            "interface": self._interface,
            "heard": _heard(self._session),
            "reopened": self._reopened,
        }

    def _broadcast(self, say: Callable[..., None], key: zenoh.KeyExpr | str, *payload: Any, **options: Any) -> None:
        """Say something on the air; at a panic of Zenoh it is lost, and the session opened anew."""
        session = self._session
        try:
            say(session, f"{ON_AIR}/{key}", *payload, **options)
        except zenoh.ZError:
            if session is self._session:
                raise
            self._broadcast(say, key, *payload, **options)  # another one took its place meanwhile
        except BaseException as error:
            if not _is_panic(error):
                raise
            self._panicked = session

    def _opened(self) -> zenoh.Session:
        try:
            with self._sockets.found():
                self._radio = interface_of(self._interface, self._radio)
                session = zenoh_session(broadcast_options(self._group, self._radio))
        except zenoh.ZError as error:
            where = f"mesh.interface {self._interface}, mesh.group {self._group}"
            if only_link_local(self._radio, self._group):
                reason = "for a group of IPv6 the interface needs an address that is not link-local"
            else:
                reason = reason_of(error).partition(": [")[2]
            raise SessionError(f"{where}: cannot broadcast: {reason}") from error
        try:
            self._subscribe(session)
        except BaseException as error:
            _close(session)
            if not _is_panic(error):
                raise
            raise SessionError(f"mesh.group {self._group}: cannot broadcast: {error}") from error
        return session

    def _subscribe(self, session: zenoh.Session) -> None:
        # These leave out Sendworthy's own keys, of which at most digests are believed here.
        attended = () if self._attend is None else (ALL_DIGESTS,)
        self._subscribers = [self._subscribed(session, key) for key in (*INGRESS, *attended)]

    def _subscribed(self, session: zenoh.Session, key: str) -> Declaration:
        handler = zenoh.handlers.Callback(partial(self._take, str(session.zid())), indirect=False)
        prefix = pattern(secrets.randbits(2 * len(ON_AIR)))
        return session.declare_subscriber(f"{prefix}/{key}", handler, allowed_origin=zenoh.Locality.REMOTE)

    def _take(self, zid: str, sample: zenoh.Sample) -> None:
        attach()
        prefix, _, key = str(sample.key_expr).partition("/")
        if prefix != ON_AIR or zid == self._left:
            return
        thread = threading.get_ident()
        self._taking.add(thread)
        try:
            if not key.startswith(f"{OWN}/"):
                self._hear(key, sample)
            elif self._attend is not None:
                self._attend(key, sample)
        finally:
            self._taking.discard(thread)
            self._taken += 1

    def _run(self) -> None:
        """Look whether anybody is heard; a dead session hears nobody."""
        patience, since = TUNING.group_silent, clock.monotonic()
        while not self._stop.wait(TUNING.group_check):
            if self._stuck() or self._sockets.closed or self._panicked is self._session:
                self._revive()
                patience, since = TUNING.group_silent, clock.monotonic()
            elif _heard(self._session) or not self._others():
                patience, since = TUNING.group_silent, clock.monotonic()
                self._silent = False
            elif clock.monotonic() - since > patience:
                self._silent = True
                self._reopen("nobody was heard")
                patience, since = min(2.0 * patience, TUNING.longest_group_silent), clock.monotonic()

    def _stuck(self) -> bool:
        """Whether Zenoh reads nothing more. Where more comes than it can read, always as much waits."""
        before, self._looked = self._looked, self._taken
        busy = bool(self._taking) or self._looked != before
        return self._sockets.stuck(TUNING.group_unread, busy=busy)

    def _revive(self) -> None:
        """Open a session anew that hears nothing more, once this host sends to the group.

        Zenoh gives up on it where the radio is off, too.
        """
        before, self._refusal, self._panicked = self._refusal, refusal(self._group, self._radio), None
        if not self._refusal:
            self._deafened += not before
            self._reopen(f"this host did not send ({before})" if before else _STRAY)
        elif not before:
            log.warning("%s on %s: this host sends nothing: %s", self._group, self._radio, self._refusal)

    def _reopen(self, reason: str) -> None:
        with self._joining:
            try:
                session = self._opened()
            except SessionError as error:
                log.warning("%s", error)  # tried again as whoever hears nobody does
                return
            old, self._session, self._left = self._session, session, str(self._session.zid())
            self._reopened += 1
        log.info("%s on %s: joined the group anew", reason, self._group)
        _close(old)


def pattern(number: int) -> str:
    """Return a pattern that `ON_AIR` matches; numbers of two bits per letter hardly ever give the same one.

    Of each letter one bit says whether "$*", which stands for any text, takes its place, the other whether it follows.
    """
    parts = (
        ("$*" if number >> 2 * i & 1 else letter) + ("$*" if number >> 2 * i & 2 else "")
        for i, letter in enumerate(ON_AIR[1:])
    )
    return ON_AIR[0] + re.sub(r"(\$\*)+", "$*", "".join(parts))


def _is_panic(error: BaseException) -> bool:
    """Whether Zenoh panicked, as at all that is said and declared after a stranger declared what is no key."""
    return type(error).__name__ == "PanicException"  # of no module


def _heard(session: zenoh.Session) -> int:
    return len({str(link.zid) for link in session.info.links()})


def _close(session: zenoh.Session) -> None:
    try:
        session.close()  # type: ignore[no-untyped-call] # the stubs leave its type out
    except zenoh.ZError as error:  # an application that hangs with one of its samples; it closes once that is over
        log.warning("a session on the group closes late: %s", error)


DataSession = zenoh.Session | Broadcast
"""Where samples travel."""
