"""Sendworthy's own keys on the mesh: digests, states and presence."""

import logging
import threading
from collections.abc import Callable
from functools import partial

import zenoh

from proxy import clock
from proxy.bridge import keys
from proxy.bridge.declaration import Declaration
from proxy.bridge.demand import Demand
from proxy.bridge.lane import Lane
from proxy.core.codec import pack_digest, pack_state, unpack_digest, unpack_state
from proxy.core.errors import MalformedWireError
from proxy.core.events import DigestHeard, Event, MalformedHeard, PeerAppeared, PeerGone, StateHeard
from proxy.core.wire import Digest, State

log = logging.getLogger(__name__)

NAME_WAIT = 0.15
"""How long a starting daemon listens for another one of its name [s]."""


def free_name(mesh: zenoh.Session, robot: str) -> str:
    """Return `robot`, or `<robot>-<zid4>` when the mesh has a daemon of that name, which is said loudly."""
    taken = threading.Event()

    def take(_: zenoh.Sample) -> None:
        taken.set()

    handler = zenoh.handlers.Callback(take, indirect=False)
    watch: Declaration = mesh.liveliness().declare_subscriber(keys.alive(robot, "*"), handler, history=True)
    found = taken.wait(NAME_WAIT)
    watch.undeclare()
    if not found:
        return robot
    name = f"{robot}-{str(mesh.zid())[:4]}"
    log.error("another daemon on the mesh is called %r; this one runs as %r: give it a name of its own", robot, name)
    return name


class Presence:
    """What this daemon tells the others beside the data, and what it hears from them.

    `post` gets events, and functions that make one: what arrives is unpacked on the loop's thread.
    """

    def __init__(
        self,
        mesh: zenoh.Session,
        robot: str,
        lane: Lane,
        post: Callable[[Event | Callable[[], Event | None]], None],
        demand: Demand,
    ) -> None:
        self._mesh = mesh
        self._robot = robot
        self._zid = str(mesh.zid())
        self._lane = lane
        self._post = post
        self._demand = demand
        self._state: bytes | None = None
        self._declared: list[Declaration] = []

    def open(self) -> None:
        """Say that we are here, and listen."""
        remote = zenoh.Locality.REMOTE
        direct = partial(zenoh.handlers.Callback, indirect=False)
        mesh = self._mesh
        self._declared = [
            mesh.declare_subscriber(keys.ALL_DIGESTS, direct(self._hear_digest), allowed_origin=remote),
            mesh.declare_subscriber(keys.ALL_STATES, direct(self._hear_state), allowed_origin=remote),
            mesh.declare_queryable(keys.state(self._robot), direct(self._tell), allowed_origin=remote),
            mesh.liveliness().declare_token(keys.alive(self._robot, self._zid)),
            mesh.liveliness().declare_subscriber(keys.ALL_ALIVE, direct(self._notice), history=True),
        ]

    def close(self) -> None:
        """Say that we are gone."""
        for declared in self._declared:
            declared.undeclare()
        self._declared = []

    def send_digest(self, digest: Digest) -> None:
        """Publish our digest."""
        self._put(keys.digest(self._robot), pack_digest(digest))

    def send_state(self, state: State) -> None:
        """Publish our state, and answer with it from now on."""
        self._state = pack_state(state)
        self._put(keys.state(self._robot), self._state)

    def _put(self, key: str, payload: bytes) -> None:
        try:
            self._mesh.put(
                key,
                payload,
                priority=zenoh.Priority.INTERACTIVE_HIGH,
                congestion_control=zenoh.CongestionControl.DROP,
                express=True,
                allowed_destination=zenoh.Locality.REMOTE,
            )
        except zenoh.ZError as error:
            log.error("cannot publish on %s: %s", key, error)

    def _tell(self, query: zenoh.Query) -> None:
        with query:
            if self._state is not None:
                query.reply(keys.state(self._robot), self._state)

    def _hear_digest(self, sample: zenoh.Sample) -> None:
        self._post(partial(self._digest, clock.monotonic(), str(sample.key_expr), bytes(sample.payload)))

    def _hear_state(self, sample: zenoh.Sample) -> None:
        self._post(partial(self._learn, clock.monotonic(), str(sample.key_expr), bytes(sample.payload)))

    def _digest(self, now: float, key: str, payload: bytes) -> Event | None:
        robot = keys.robot_of(key)
        try:
            digest = unpack_digest(payload)
        except MalformedWireError:
            return MalformedHeard(now, robot)
        return self._accept(robot, digest, DigestHeard(now, digest))

    def _learn(self, now: float, key: str, payload: bytes) -> Event | None:
        robot = keys.robot_of(key)
        try:
            state = unpack_state(payload)
        except MalformedWireError:
            return MalformedHeard(now, robot)
        if not all(_is_key_expression(subscription) for subscription in state.subscriptions):
            return MalformedHeard(now, robot)
        event = self._accept(robot, state, StateHeard(now, state))
        if isinstance(event, StateHeard):
            self._demand.told(state.zid, state.subscriptions)
        return event

    def _accept(self, robot: str, told: Digest | State, event: Event) -> Event | None:
        """Return `event`, unless somebody speaks in another's name, or in ours (`_notice` has said that)."""
        if told.robot != robot:
            return MalformedHeard(event.now, robot)
        return None if robot == self._robot else event

    def _notice(self, sample: zenoh.Sample) -> None:
        token = str(sample.key_expr)
        robot, zid = keys.robot_of(token), keys.zid_of(token)
        if zid == self._zid:
            return
        if robot == self._robot:
            if sample.kind == zenoh.SampleKind.PUT:
                log.error("another daemon on the mesh is called %r too (session %s): rename one", robot, zid)
            return
        if sample.kind == zenoh.SampleKind.DELETE:
            self._demand.told(zid, ())
            self._post(PeerGone(clock.monotonic(), robot, zid))
            return
        self._post(PeerAppeared(clock.monotonic(), robot, zid))
        self._lane.offer(partial(self._fetch, robot))

    def _fetch(self, robot: str) -> None:
        """Ask a robot for its state: it may have published it before we were linked."""

        def take(reply: zenoh.Reply) -> None:
            if reply.ok is not None:
                self._hear_state(reply.ok)

        handler = zenoh.handlers.Callback(take, indirect=False)
        self._mesh.get(keys.state(robot), handler, timeout=5.0, allowed_destination=zenoh.Locality.REMOTE)


def _is_key_expression(text: str) -> bool:
    try:
        zenoh.KeyExpr(text)
    except zenoh.ZError:
        return False
    return True
