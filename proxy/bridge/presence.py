"""Sendworthy's own keys on the mesh: digests, states and presence."""

import logging
import threading
from collections import deque
from collections.abc import Callable
from functools import partial

import zenoh

from proxy import clock
from proxy.bridge import keys
from proxy.bridge.air import Broadcast
from proxy.bridge.declaration import Declaration
from proxy.bridge.lane import Lane
from proxy.bridge.tokens import Tokens
from proxy.core.codec import MAX_BYTES, MAX_DIGEST, pack_digest, pack_state, unpack_digest, unpack_state
from proxy.core.errors import MalformedWireError
from proxy.core.events import DigestHeard, Event, MalformedHeard, StateAsked, StateHeard
from proxy.core.fixed import ticks
from proxy.core.wire import Digest, State, tag

log = logging.getLogger(__name__)

NAME_WAIT = 0.15
"""How long a starting daemon listens for another one of its name [s]."""
ADDRESSED = 256
"""Robots that have a number for digests to them alone."""
ECHOED = 64
"""Of so many of our digests an echo is understood."""
STATES = 64
"""States that may wait to be read."""
ANSWERS = 50
"""Questions answered per second."""

Job = Callable[[], Event | None]
Post = Callable[[Event | Job], object]
Offer = Callable[[Event | Job], bool]


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

    `post` gets events, and functions that make one: what arrives is unpacked on the loop's thread. `offer` gets what
    may be left out when the loop is behind. With `air` digests that concern all are broadcast.
    """

    def __init__(
        self, mesh: zenoh.Session, robot: str, lane: Lane, post: Post, offer: Offer, *, air: Broadcast | None = None
    ) -> None:
        self._mesh = mesh
        self._air = air
        self._robot = robot
        self._zid = str(mesh.zid())
        self._tag = tag(self._zid)
        self._lane = lane
        self._offer = offer
        self._state: bytes | None = None
        self._sent: deque[int] = deque(maxlen=ECHOED)
        self._answered: deque[float] = deque(maxlen=ANSWERS)
        self._waiting = threading.BoundedSemaphore(STATES)
        self._tokens = Tokens(self._zid, post)
        self._declared: list[Declaration] = []
        self._addressed: dict[str, Declaration] = {}
        """To whom digests were sent alone, the last one last: such keys are declared, so that a number travels."""

    def open(self) -> None:
        """Say that we are here, and listen."""
        remote = zenoh.Locality.REMOTE
        direct = partial(zenoh.handlers.Callback, indirect=False)
        mesh, robot = self._mesh, self._robot
        if self._air is not None:
            self._air.attend(self._hear_told)
        self._declared = [
            mesh.declare_subscriber(keys.ALL_DIGESTS, direct(self._hear_digest), allowed_origin=remote),
            mesh.declare_subscriber(
                keys.digest_to(self._tag, "*", "*"), direct(self._hear_digest), allowed_origin=remote
            ),
            mesh.declare_subscriber(keys.ALL_STATES, direct(self._hear_state), allowed_origin=remote),
            mesh.declare_queryable(keys.state(robot, self._tag), direct(self._tell), allowed_origin=remote),
            # Nobody asks for digests: but what is declared has a number, which travels instead of the key.
            mesh.declare_queryable(keys.digest(robot, self._tag), direct(_ignore), allowed_origin=remote),
            mesh.liveliness().declare_token(keys.alive(robot, self._zid)),
            mesh.liveliness().declare_subscriber(keys.ALL_ALIVE, direct(self._notice), history=True),
        ]

    def close(self) -> None:
        """Say that we are gone."""
        for declared in self._declared:
            declared.undeclare()
        self._declared = []
        for addressed in self._addressed.values():
            addressed.undeclare()
        self._addressed.clear()

    def send_digest(self, digest: Digest, to: str = "") -> None:
        """Publish our digest, or send it only to the robot with the tag `to`."""
        self._sent.append(ticks(digest.sent))
        if self._air is not None and not to:
            self._put(keys.digest(self._robot, self._tag), pack_digest(digest), self._air.announce)
            return
        key = keys.digest_to(to, self._robot, self._tag) if to else keys.digest(self._robot, self._tag)
        if to:
            self._number(to, key)
        self._put(key, pack_digest(digest))

    def _number(self, to: str, key: str) -> None:
        """Declare the key of digests to this robot; that of whom none was sent to for longest gives way."""
        declared = self._addressed.pop(to, None)
        if declared is None:
            numbered = zenoh.handlers.Callback(_ignore, indirect=False)
            declared = self._mesh.declare_queryable(key, numbered, allowed_origin=zenoh.Locality.REMOTE)
        self._addressed[to] = declared
        if len(self._addressed) > ADDRESSED:
            self._addressed.pop(next(iter(self._addressed))).undeclare()

    def send_state(self, state: State, update: State | None = None) -> None:
        """Answer with our state from now on, and publish it, or instead of it the update."""
        self._state = pack_state(state)
        self._put(keys.state(self._robot, self._tag), self._state if update is None else pack_state(update))

    def ask_state(self, robot: str, name: str) -> None:
        """Ask the robot with this name and tag for its state: it was published before we were linked, or got lost."""
        self._lane.offer(partial(self._fetch, robot, name))

    def _put(self, key: str, payload: bytes, announce: Callable[[str, bytes], None] | None = None) -> None:
        try:
            if announce is None:
                self._mesh.put(key, payload, **keys.ANNOUNCED)
            else:
                announce(key, payload)
        except zenoh.ZError as error:
            log.error("cannot publish on %s: %s", key, error)

    def _tell(self, query: zenoh.Query) -> None:
        """Answer a question, if there were not too many: who asks in vain asks again."""
        now = clock.monotonic()
        with query:
            if self._state is None or (len(self._answered) == ANSWERS and now < self._answered[0] + 1.0):
                return
            self._answered.append(now)
            query.reply(keys.state(self._robot, self._tag), self._state)
        self._offer(StateAsked(now))

    def _hear_digest(self, sample: zenoh.Sample) -> None:
        self._hear_told(str(sample.key_expr), sample)

    def _hear_told(self, key: str, sample: zenoh.Sample) -> None:
        if len(sample.payload) > MAX_DIGEST:
            self._offer(MalformedHeard(clock.monotonic(), "", "digest:malformed"))
        else:
            self._offer(partial(self._digest, clock.monotonic(), key, sample))

    def _hear_state(self, sample: zenoh.Sample) -> None:
        """States are large: few may wait. One that is not taken in is asked for."""
        if len(sample.payload) > MAX_BYTES:
            self._offer(MalformedHeard(clock.monotonic(), "", "state:malformed"))
        elif not self._waiting.acquire(blocking=False):
            self._offer(MalformedHeard(clock.monotonic(), "", "state:flood"))
        elif not self._offer(partial(self._learn, clock.monotonic(), sample)):
            self._waiting.release()

    def _digest(self, now: float, key: str, sample: zenoh.Sample) -> Event | None:
        robot, name = keys.robot_of(key), keys.zid_of(key)
        try:
            digest = unpack_digest(bytes(sample.payload), robot, name, self._tag, self._sent)
        except MalformedWireError:
            return MalformedHeard(now, robot, "digest:malformed")
        return DigestHeard(now, digest)

    def _learn(self, now: float, sample: zenoh.Sample) -> Event | None:
        self._waiting.release()
        key = str(sample.key_expr)
        robot, name = keys.robot_of(key), keys.zid_of(key)
        try:
            state = unpack_state(bytes(sample.payload), robot)
        except MalformedWireError:
            return MalformedHeard(now, robot, "state:malformed")
        if not all(_is_key_expression(key) for key in (*state.subscriptions, *(s.key for s in state.streams))):
            return MalformedHeard(now, robot, "state:malformed")
        if tag(state.zid) != name:
            return MalformedHeard(now, robot, "state:forged")
        return StateHeard(now, state)

    def _notice(self, sample: zenoh.Sample) -> None:
        self._tokens.note(str(sample.key_expr), there=sample.kind == zenoh.SampleKind.PUT)

    def _fetch(self, robot: str, name: str) -> None:
        def take(reply: zenoh.Reply) -> None:
            if reply.ok is not None:
                self._hear_state(reply.ok)

        handler = zenoh.handlers.Callback(take, indirect=False)
        key = keys.state(robot, name)
        self._mesh.get(key, handler, timeout=5.0, allowed_destination=zenoh.Locality.REMOTE)


def _ignore(query: zenoh.Query) -> None:
    with query:
        pass


def _is_key_expression(text: str) -> bool:
    try:
        zenoh.KeyExpr(text)
    except zenoh.ZError:
        return False
    return True
