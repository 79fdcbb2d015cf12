"""Sendworthy's own keys on the mesh: digests, states and presence.

Whoever is on the mesh can publish there as much as the links carry. So a message is first looked at where it comes:
whether its size and its first bytes are those of one, and whether it tells something new; and each robot, and all
together that are not known yet, may say so much a second. Only the rest is read, on the loop's thread.
"""

import logging
import math
import threading
from collections import deque
from collections.abc import Callable, Collection
from functools import partial

import zenoh

from proxy import clock
from proxy.bridge import keys
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.broadcast import Broadcast
from proxy.bridge.budget import Budget
from proxy.bridge.declaration import Declaration
from proxy.bridge.floods import Floods
from proxy.bridge.hold_back import HoldBack
from proxy.bridge.identities import Identities
from proxy.bridge.serial_executor import SerialExecutor
from proxy.bridge.tokens import Later, Tokens
from proxy.core.interface.events import DigestHeard, Event, StateAsked, StateHeard, VersionHeard
from proxy.core.protocol.digest_codec import digest_head, pack_digest, unpack_digest
from proxy.core.protocol.envelope import MalformedWireError, OtherVersionError
from proxy.core.protocol.fixed import ticks
from proxy.core.protocol.messages import Digest, State, tag
from proxy.core.protocol.state_codec import pack_backlog, pack_state, state_version, unpack_backlog, unpack_state
from proxy.core.protocol.tuning import TUNING as PROTOCOL

log = logging.getLogger(__name__)


Job = Callable[[], Event | None]
Post = Callable[[Event | Job], object]
Offer = Callable[[Event | Job], bool]
Old = Callable[[float, str, float], bool]


class Presence:
    """What this daemon tells the others beside the data, and what it hears from them.

    `post` gets events, and functions that make one: what arrives is unpacked on the loop's thread; `later` gets them
    with the time when they are due [s]. `offer` gets what may be left out when the loop is behind, `note` what may also
    wait for what happens next. `old` tells whether the core has heard a digest of a tag that was sent then [s], or a
    later one; from any thread. With `broadcast` that is where digests go. `hold_back` is told who vanishes, returns,
    and has copies for us. `certified` robots are those whose certificates access control knows.
    """

    def __init__(
        self,
        mesh: zenoh.Session,
        robot: str,
        executor: SerialExecutor,
        post: Post,
        offer: Offer,
        *,
        note: Callable[[Job], object],
        later: Later,
        old: Old,
        hold_back: HoldBack,
        broadcast: Broadcast | None = None,
        certified: Collection[str] = (),
    ) -> None:
        self._mesh = mesh
        self._broadcast = broadcast
        self._robot = robot
        self._zid = str(mesh.zid())
        self._tag = tag(self._zid)
        self._executor = executor
        self._offer = offer
        self._note = note
        self._state: bytes | None = None
        self._sent: deque[int] = deque(maxlen=BOUNDS.echoed_digests)
        self._answered: deque[float] = deque(maxlen=BOUNDS.answers)
        self._told_all = -math.inf
        self._old = old
        self.floods = Floods(offer)
        self._hold_back = hold_back
        identities = Identities(mesh, certified)
        self._tokens = Tokens(
            self._zid,
            post,
            later,
            self.floods.refuse,
            lost=hold_back.lost,
            found=hold_back.found,
            forged=identities.forged,
            absent=identities.absent,
            strange=identities.strange,
        )
        self._looking = threading.Lock()
        self._digests = Budget(BOUNDS.digests, BOUNDS.all_digests, lambda: len(self._tokens.tags))
        self._states = Budget(BOUNDS.states, BOUNDS.all_states, lambda: len(self._tokens.tags))
        self._words = Budget(BOUNDS.backlogs, BOUNDS.all_backlogs, lambda: len(self._tokens.tags))
        self._versions: dict[str, int] = {}
        """What each robot speaks, as the core was told."""
        self._declared: list[Declaration] = []

    def open(self) -> None:
        """Say that we are here, and listen."""
        remote = zenoh.Locality.REMOTE
        direct = partial(zenoh.handlers.Callback, indirect=False)
        mesh, robot = self._mesh, self._robot
        if self._broadcast is not None:
            self._broadcast.attend(self._hear_digest_of)
        self._declared = [
            mesh.declare_subscriber(keys.ALL_DIGESTS, direct(self._hear_digest), allowed_origin=remote),
            mesh.declare_subscriber(keys.ALL_STATES, direct(self._hear_state), allowed_origin=remote),
            mesh.declare_subscriber(keys.backlog(self._tag, "*"), direct(self._hear_backlog), allowed_origin=remote),
            mesh.declare_queryable(keys.state(robot, self._tag), direct(self._answer_state), allowed_origin=remote),
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

    def send_digest(self, digest: Digest) -> None:
        """Publish our digest."""
        self._sent.append(ticks(digest.sent))
        announce = None if self._broadcast is None else self._broadcast.announce
        self._put(keys.digest(self._robot, self._tag), pack_digest(digest), announce)

    def send_state(self, state: State, update: State | None = None) -> None:
        """Answer with our state from now on, and publish it, or instead of it the update."""
        self._state = pack_state(state)
        self._put(keys.state(self._robot, self._tag), self._state if update is None else pack_state(update))

    def ask_state(self, robot: str, name: str) -> None:
        """Ask the robot with this name and tag for its state: it was published before we were linked, or got lost."""
        self._executor.offer(partial(self._fetch, robot, name))

    def tell_backlog(self, to: str, number: int, named: tuple[str, ...] | None, *, grows: bool) -> None:
        """Tell the robot with the tag `to` of which keys copies wait for it, after those that were sent unless `grows`.

        Zenoh keeps the order of what has one priority, and takes what has a higher one first.
        """
        priority = keys.ANNOUNCED["priority"] if grows else zenoh.Priority.BACKGROUND
        self._put(keys.backlog(to, self._tag), pack_backlog(number, named), priority=priority)

    def _put(
        self, key: str, payload: bytes, announce: Callable[[str, bytes], None] | None = None, **how: object
    ) -> None:
        try:
            if announce is None:
                self._mesh.put(key, payload, **{**keys.ANNOUNCED, **how})
            else:
                announce(key, payload)
        except zenoh.ZError as error:
            if self._declared:  # else we leave: the loop may have been too busy to end before the session
                log.error("cannot publish on %s: %s", key, error)

    def _answer_state(self, query: zenoh.Query) -> None:
        """Answer a question; nobody knows whose it is, so where there are too many all are told."""
        now = clock.monotonic()
        with query:
            if self._state is None:
                return
            if len(self._answered) == BOUNDS.answers and now < self._answered[0] + 1.0:
                self._tell_all(now, self._state)
                return
            self._answered.append(now)
            query.reply(keys.state(self._robot, self._tag), self._state)
        self._offer(StateAsked(now))

    def _tell_all(self, now: float, state: bytes) -> None:
        """Publish our state in place of an answer, now and then."""
        self.floods.refuse(now, self._robot, "question:flood")
        if now >= self._told_all + BOUNDS.states_to_all:
            self._told_all = now
            self._executor.offer(partial(self._put, keys.state(self._robot, self._tag), state))

    def _hear_digest(self, sample: zenoh.Sample) -> None:
        self._hear_digest_of(str(sample.key_expr), sample)

    def _hear_digest_of(self, key: str, sample: zenoh.Sample) -> None:
        """Take in a digest if it is one and tells something new."""
        now, name = clock.monotonic(), keys.zid_of(key)
        size = len(sample.payload)
        data = sample.payload.to_bytes() if size <= PROTOCOL.digest_bytes else b""
        robot, known = keys.robot_of(key), name in self._tokens.tags
        try:
            version, sent = digest_head(data)
        except OtherVersionError as error:
            self._note_version(now, name, error.version)
            self.floods.refuse(now, robot, "digest:other version")
        except MalformedWireError:
            self.floods.refuse(now, robot, "digest:malformed")
        else:
            if name == self._tag:
                self.floods.refuse(now, robot, "digest:forged")
            elif known and self._old(now, name, sent):
                self.floods.refuse(now, robot, "digest:old")
            elif not self._admits(self._digests, now, name if known else "", 1.0 + size / BOUNDS.digest_bytes):
                self.floods.refuse(now, robot, "digest:flood")
            else:
                self._note_version(now, name, version)
                self._note(partial(self._digest, now, robot, name, data))

    def _hear_state(self, sample: zenoh.Sample) -> None:
        """States are large, and one that is not taken in is asked for: of who is not known none is read."""
        now, key = clock.monotonic(), str(sample.key_expr)
        robot, name = keys.robot_of(key), keys.zid_of(key)
        if len(sample.payload) > PROTOCOL.state_bytes:
            self.floods.refuse(now, robot, "state:malformed")
        elif name not in self._tokens.tags:
            self.floods.refuse(now, robot, "state:unknown")
        elif not self._admits(self._states, now, name):
            self.floods.refuse(now, robot, "state:flood")
        else:
            self._offer(partial(self._learn, now, robot, name, sample.payload.to_bytes()))

    def _hear_backlog(self, sample: zenoh.Sample) -> None:
        """Take in of which keys copies wait for us: each word is read at once, of who is known, within its part."""
        now, key = clock.monotonic(), str(sample.key_expr)
        name = keys.zid_of(key)
        if name not in self._tokens.tags:
            return
        if len(sample.payload) > PROTOCOL.backlog_bytes or not self._admits(self._words, now, name):
            self.floods.refuse(now, name, "backlog:flood")
            return
        try:
            number, named = unpack_backlog(sample.payload.to_bytes())
        except MalformedWireError:
            self.floods.refuse(now, name, "backlog:malformed")
        else:
            self._hold_back.note_backlog(name, number, named)

    def _admits(self, budget: Budget, now: float, name: str, cost: float = 1.0) -> bool:
        with self._looking:
            return budget.admits(now, name, cost)

    def _note_version(self, now: float, name: str, version: int) -> None:
        """Tell the core what a robot speaks, if that is news; not more often than it may send digests."""
        if name not in self._tokens.tags or self._versions.get(name) == version:
            return
        if not self._admits(self._digests, now, name):
            return
        if len(self._versions) >= BOUNDS.tokens:
            self._versions.clear()
        if self._offer(VersionHeard(now, name, version)):
            self._versions[name] = version

    def _digest(self, now: float, robot: str, name: str, data: bytes) -> Event | None:
        try:
            return DigestHeard(now, unpack_digest(data, robot, name, self._tag, self._sent), len(data))
        except MalformedWireError:
            self.floods.refuse(now, robot, "digest:malformed")
            return None

    def _learn(self, now: float, robot: str, name: str, data: bytes) -> Event | None:
        try:
            self._note_version(now, name, state_version(data))
            state = unpack_state(data, robot)
        except OtherVersionError as error:
            self._note_version(now, name, error.version)
            wrong = "state:other version"
        except MalformedWireError:
            wrong = "state:malformed"
        else:
            wrong = _wrong(state, name)
            if not wrong:
                return StateHeard(now, state, len(data))
        self.floods.refuse(now, robot, wrong)
        return None

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


def _wrong(state: State, name: str) -> str:
    """Say what is wrong with a state on the key of a tag, if anything is."""
    if not all(_is_key_expression(key) for key in (*state.subscriptions, *(s.key for s in state.streams))):
        return "state:malformed"
    return "" if tag(state.zid) == name else "state:forged"


def _is_key_expression(text: str) -> bool:
    try:
        zenoh.KeyExpr(text)
    except zenoh.ZError:
        return False
    return True
