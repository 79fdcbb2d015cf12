"""What daemons tell each other beside the data, on real sessions."""

import threading
from collections import Counter
from functools import partial

import msgpack
import pytest
import zenoh

from proxy import clock
from proxy.bridge import keys
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.hold_back import HoldBack
from proxy.bridge.presence import Presence
from proxy.bridge.serial_executor import SerialExecutor
from proxy.core.gossip.tuning import TUNING as GOSSIP
from proxy.core.interface.events import (
    DigestHeard,
    MalformedHeard,
    PeerAppeared,
    PeerGone,
    StateAsked,
    StateHeard,
    VersionHeard,
)
from proxy.core.protocol.digest_codec import pack_digest
from proxy.core.protocol.envelope import VERSION
from proxy.core.protocol.messages import Digest, Echo, State, StreamState, tag
from proxy.core.protocol.state_codec import pack_backlog, pack_state
from proxy.core.protocol.tuning import TUNING
from tests.proxy.counting import Counting
from tests.proxy.nodes import Heard, closing, free_endpoint, plain_session, wait_matching
from tests.waiting import wait_until

BLOCK = zenoh.CongestionControl.BLOCK


class Voiced:
    """A robot that only speaks for itself. Functions that make events are run as the loop would."""

    def __init__(self, stack, robot, connect=()):
        self.endpoint = free_endpoint()
        self.mesh = closing(stack, plain_session("peer", listen=(self.endpoint,), connect=connect))
        self.zid = str(self.mesh.zid())
        self.robot = robot
        self.events = []
        executor = SerialExecutor("test")
        stack.callback(executor.close, 1.0)
        self.heard = {}
        """When the last digest of a tag was sent that the core has taken in."""
        self.hold_back = HoldBack(lambda _: "")
        self.presence = Presence(
            self.mesh,
            robot,
            executor,
            self._post,
            self._post,
            note=self._post,
            later=self._post_later,
            old=lambda _, name, sent: sent <= self.heard.get(name, -1.0),
            hold_back=self.hold_back,
        )
        stack.callback(self.presence.close)

    def _post(self, item):
        event = item() if callable(item) else item
        if event is not None:
            self.events.append(event)
        return True

    def _post_later(self, when, job):
        timer = threading.Timer(when - clock.monotonic(), self._post, [job])
        timer.daemon = True
        timer.start()

    def of(self, kind):
        return [event for event in list(self.events) if isinstance(event, kind)]

    def digest(self, **changes):
        told = {"robot": self.robot, "tag": tag(self.zid), "sent": 1.0, "messages": 3, "bytes": 4}
        return Digest(**told | changes)

    def insist(self, **changes):
        """Send a digest that Zenoh may not drop, however many there are."""
        self.mesh.put(
            keys.digest(self.robot, tag(self.zid)),
            pack_digest(self.digest(**changes)),
            congestion_control=zenoh.CongestionControl.BLOCK,
        )

    def state(self, **changes):
        return State(**{"robot": self.robot, "zid": self.zid, "mode": "enforce", "specs": "s"} | changes)


@pytest.fixture
def two(stack):
    first = Voiced(stack, "r1")
    second = Voiced(stack, "r2", (first.endpoint,))
    for voiced in (first, second):
        voiced.presence.open()
    wait_until(lambda: first.of(PeerAppeared) and second.of(PeerAppeared), what="both to see each other")
    return first, second


def test_robots_see_each_other_come_and_go(two):
    """Presence tells robot and session, and its end is told too."""
    first, second = two
    assert [(e.robot, e.zid) for e in first.of(PeerAppeared)] == [("r2", second.zid)]
    second.presence.close()
    wait_until(lambda: first.of(PeerGone), what="the end")
    assert [(e.robot, e.zid) for e in first.of(PeerGone)] == [("r2", second.zid)]


def test_what_cannot_be_said_is_logged_unless_the_daemon_leaves(two, caplog):
    """A busy loop may end after the session: nothing is wrong then, and nobody need read of it."""
    first, _ = two
    first.mesh.close()
    first.presence.send_digest(first.digest())
    assert "cannot publish on @sendworthy/r1/digest/" in caplog.text
    caplog.clear()
    first.presence.close()
    first.presence.send_digest(first.digest())
    assert not caplog.text


def test_digests_arrive_at_high_priority_and_not_at_their_sender(two):
    """A digest is an urgent message that may be dropped; nobody hears its own."""
    first, second = two
    raw = Heard(second.mesh, keys.ALL_DIGESTS)
    first.presence.send_digest(first.digest())
    wait_until(lambda: second.of(DigestHeard) and raw.samples, what="the digest")
    assert second.of(DigestHeard)[0].digest == first.digest()
    sample = raw.samples[0]
    assert (sample.priority, sample.express) == (zenoh.Priority.INTERACTIVE_HIGH, True)
    assert sample.congestion_control == zenoh.CongestionControl.DROP
    assert not first.of(DigestHeard)


def test_who_has_copies_for_us_tells_of_which_keys(two):
    """What is new of these waits; the word that lets it go on overtakes nothing. Of who is not known none is read."""
    first, second = two
    raw, handed = Heard(second.mesh, keys.backlog(tag(second.zid), "*")), []
    wait_matching(first.mesh, keys.backlog(tag(second.zid), tag(first.zid)))
    second.hold_back.lost(tag(first.zid))
    second.hold_back.found(tag(first.zid))
    first.presence.tell_backlog(tag(second.zid), 1, ("a",), grows=True)
    wait_until(lambda: raw.samples, what="the first word")
    assert second.hold_back.takes("a", None, 1, lambda: handed.append("a"))
    for payload in (b"\xc1", pack_backlog(0, ()), bytes(TUNING.backlog_bytes + 1)):
        first.mesh.put(keys.backlog(tag(second.zid), tag(first.zid)), payload, congestion_control=BLOCK)
    first.mesh.put(keys.backlog(tag(second.zid), "stranger"), pack_backlog(9, ()), congestion_control=BLOCK)
    wait_until(lambda: len(raw.samples) == 5, what="what changes nothing")
    assert handed == []
    first.presence.tell_backlog(tag(second.zid), 2, (), grows=False)
    wait_until(lambda: handed == ["a"], what="its turn")
    assert [str(sample.priority) for sample in (raw.samples[0], raw.samples[-1])] == [
        str(zenoh.Priority.INTERACTIVE_HIGH),
        str(zenoh.Priority.BACKGROUND),
    ]


def test_a_state_is_told_to_who_asks(stack):
    """A state published to nobody is known to a robot that asks for it, and that it was asked for is told."""
    first = Voiced(stack, "r1")
    first.presence.open()
    first.presence.send_state(first.state(subscriptions=("a/*",)))
    second = Voiced(stack, "r2", (first.endpoint,))
    second.presence.open()
    wait_until(lambda: second.of(PeerAppeared), what="the robot")
    second.presence.ask_state("r1", tag(first.zid))
    wait_until(lambda: second.of(StateHeard), what="the state")
    assert second.of(StateHeard)[0].state == first.state(subscriptions=("a/*",))
    wait_until(lambda: len(first.of(StateAsked)) == 1, what="the word of it")


def test_who_has_no_state_yet_answers_nothing(two):
    """The question costs nothing then."""
    first, second = two
    second.presence.ask_state("r1", tag(first.zid))
    second.presence.ask_state("r2", "nobody")
    second.presence.send_state(second.state())
    wait_until(lambda: first.of(StateHeard), what="a state the other way")
    assert not first.of(StateAsked)


def test_too_many_questions_are_not_answered(two, monkeypatch):
    """Answers cost allowance: so many a second and no more."""
    first, second = two
    first.presence.send_state(first.state())
    key, now = keys.state("r1", tag(first.zid)), 1000.0
    monkeypatch.setattr("proxy.clock.monotonic", lambda: now)
    asked = [len(list(second.mesh.get(key, timeout=5.0))) for _ in range(BOUNDS.answers + 5)]
    assert asked == [1] * BOUNDS.answers + [0] * 5
    now += 1.0
    assert len(list(second.mesh.get(key, timeout=5.0))) == 1
    wait_until(lambda: len(first.of(StateAsked)) == BOUNDS.answers + 1, what="the word of each answer")


def test_a_changed_state_is_published(two):
    """Those who are there learn of a change without asking; where there is an update, of that alone."""
    first, second = two
    first.presence.send_state(first.state(mode="shadow", number=1))
    streams = (StreamState(1, "a/b", "camera", 0.5),)
    update = State("r1", first.zid, "", "", streams, number=2, since=1)
    first.presence.send_state(first.state(mode="shadow", streams=streams, number=2), update)
    wait_until(lambda: len(second.of(StateHeard)) == 2, what="both states")
    assert [event.state for event in second.of(StateHeard)] == [first.state(mode="shadow", number=1), update]


def test_a_digest_takes_few_bytes_whatever_the_name(stack):
    """Zenoh sends a number for the key: its part of a digest is as large as we count it."""
    first = Voiced(stack, "robot-with-a-long-name")
    first.presence.open()
    with Counting(first.endpoint) as counting:
        second = Voiced(stack, "r2", (counting.endpoint,))
        raw = Heard(second.mesh, keys.ALL_DIGESTS)
        second.presence.open()
        wait_until(lambda: first.of(PeerAppeared), what="the second")
        first.presence.send_digest(first.digest())
        wait_until(lambda: raw.samples, what="the first digest")
        sizes = []
        for sent in range(1, 6):
            before, heard = counting.carried, len(raw.samples)
            digest = first.digest(sent=1000.0 + sent)
            first.presence.send_digest(digest)
            wait_until(lambda heard=heard: len(raw.samples) > heard, what="a digest")
            sizes.append(counting.carried - before - len(pack_digest(digest)))
    # Frames are counted from a random number on, which is shorter by a byte on one link of 128, and so on.
    assert GOSSIP.overhead - 3 <= min(sizes) <= GOSSIP.overhead


def test_echoes_are_read_with_the_times_at_which_we_sent(two):
    """Only the last digits of a time travel."""
    first, second = two
    first.presence.send_digest(first.digest(sent=123456.7891))
    echoes = (Echo(tag(first.zid), 123456.7891, 5.0, 3, 0.0), Echo(tag(first.zid), 99.0, 5.0, 3, 0.0))
    second.presence.send_digest(second.digest(sent=5.5, echoes=echoes))
    wait_until(lambda: first.of(DigestHeard), what="the echo")
    assert first.of(DigestHeard)[0].digest.echoes == echoes[:1]


def test_malformed_and_forged_messages_are_counted_by_kind(stack, two):
    """Garbage, giants, states that name another session than their key and subscribe to nonsense change nothing."""
    first, _ = two
    hostile = closing(stack, plain_session("peer", connect=(first.endpoint,)))
    probe = hostile.declare_publisher(keys.digest("r9", "z9"))
    wait_until(lambda: probe.matching_status.matching, what="the link")

    def put(key, payload):
        hostile.put(key, payload, congestion_control=zenoh.CongestionControl.BLOCK)

    zid = str(hostile.zid())
    token = hostile.liveliness().declare_token(keys.alive("r9", zid))
    wait_until(lambda: [e for e in first.of(PeerAppeared) if e.zid == zid], what="its token")
    name = tag(zid)
    put(keys.digest("r9", "z9"), b"garbage")
    put(keys.digest("r9", "z9"), b"\x00" * (TUNING.digest_bytes + 1))
    put(keys.state("r9", "z9"), pack_state(State("r9", "z9", "", "")))
    put(keys.state("r9", name), b"\xff" * 100)
    put(keys.state("r9", name), b"\xff" * (TUNING.state_bytes + 1))
    put(keys.state("r9", name), pack_state(State("r9", "another", "", "")))
    put(keys.state("r9", name), pack_state(State("r9", zid, "", "", subscriptions=("a//b",))))
    put(keys.digest("r1", tag(first.zid)), pack_digest(first.digest()))
    wait_until(lambda: len(first.of(MalformedHeard)) == 8, what="what is malformed")
    kinds = Counter(event.kind for event in first.of(MalformedHeard))
    refused = {"digest:malformed": 2, "digest:forged": 1, "state:malformed": 3, "state:forged": 1, "state:unknown": 1}
    assert kinds == refused
    assert not first.of(DigestHeard)
    token.undeclare()


def test_what_one_robot_says_is_bounded_whoever_says_it(stack, two, monkeypatch):
    """Digests and states beyond its part are not read, and told as a flood; another robot's are."""
    now = 1000.0
    monkeypatch.setattr("proxy.clock.monotonic", lambda: now)
    first, second = two
    third = Voiced(stack, "r3", (first.endpoint,))
    third.presence.open()
    wait_until(lambda: len(first.of(PeerAppeared)) == 2, what="the third")
    most = 2 * int(BOUNDS.digests)
    for sent in range(1, most + 1):
        second.insist(sent=float(sent))
    wait_until(lambda: len(first.of(DigestHeard)) + flooded(first) >= most, what="the flood's end")
    assert 0 < len(first.of(DigestHeard)) <= BOUNDS.digests
    third.presence.send_digest(third.digest())
    wait_until(lambda: first.of(DigestHeard)[-1].digest.robot == "r3", what="the other robot's")
    for _ in range(2 * int(BOUNDS.states)):
        payload, block = pack_state(second.state(number=1)), zenoh.CongestionControl.BLOCK
        second.mesh.put(keys.state("r2", tag(second.zid)), payload, congestion_control=block)
    third.presence.send_state(third.state(number=1))
    wait_until(lambda: [e for e in first.of(StateHeard) if e.state.robot == "r3"], what="the other robot's state")
    wait_until(lambda: first.of(MalformedHeard)[-1].kind == "state:flood", what="the surplus")
    assert len(first.of(StateHeard)) <= BOUNDS.states + 1


def test_who_asks_without_end_keeps_the_state_from_nobody(stack, two):
    """Where more is asked than is answered all are told, now and then; what is too much is counted."""
    first, second = two
    first.presence.send_state(first.state(number=1))
    wait_until(lambda: second.of(StateHeard), what="the state")
    stranger = closing(stack, plain_session("peer", connect=(first.endpoint,)))
    asked = partial(stranger.get, keys.ALL_STATES, zenoh.handlers.Callback(lambda _: None))
    wait_until(lambda: asked() or flooded(first, "question:flood"), what="more than is answered")
    wait_until(lambda: len(second.of(StateHeard)) > 1, what="the state, that it did not ask for")
    assert {event.state.zid for event in second.of(StateHeard)} == {first.zid}


def flooded(robot, kind="digest:flood"):
    robot.presence.floods.flush(0.0)
    return sum(event.count for event in robot.of(MalformedHeard) if event.kind == kind)


def test_digests_that_were_heard_before_take_nothing_from_those_that_come(two):
    """A replay is told from news before anything counts against its robot."""
    first, second = two
    first.heard[tag(second.zid)] = 5.0
    for sent in (3.0, 5.0) * int(BOUNDS.digests):
        second.insist(sent=sent)
    second.insist(sent=6.0)
    wait_until(lambda: first.of(DigestHeard), what="the news")
    assert [event.digest.sent for event in first.of(DigestHeard)] == [6.0]
    assert {event.kind for event in first.of(MalformedHeard)} == {"digest:old"}


def test_the_core_is_told_which_version_a_robot_speaks(two):
    """Whether it is understood or not, and only when that changes."""
    first, second = two
    key = keys.digest("r2", tag(second.zid))
    for version in (VERSION, VERSION, VERSION + 7, VERSION + 7):
        second.mesh.put(key, msgpack.packb([version, *msgpack.unpackb(pack_digest(second.digest()))[1:]]))
    state = msgpack.packb([VERSION + 7, "?"])
    second.mesh.put(keys.state("r2", tag(second.zid)), state)
    wait_until(lambda: len(first.of(MalformedHeard)) == 3, what="what is not understood")
    assert [(e.tag, e.version) for e in first.of(VersionHeard)] == [
        (tag(second.zid), v) for v in (VERSION, VERSION + 7)
    ]
    assert len(first.of(DigestHeard)) == 2
    kinds = Counter(event.kind for event in first.of(MalformedHeard))
    assert kinds == {"digest:other version": 2, "state:other version": 1}


def test_robots_of_one_name_hear_each_other(stack):
    """Clones that meet only now are told apart by their tags, in all that they say."""
    first = Voiced(stack, "r1")
    first.presence.open()
    second = Voiced(stack, "r1", (first.endpoint,))
    second.presence.open()
    wait_until(lambda: first.of(PeerAppeared) and second.of(PeerAppeared), what="both to see each other")
    second.presence.send_digest(second.digest())
    second.presence.send_state(second.state(number=1))
    wait_until(lambda: first.of(DigestHeard) and first.of(StateHeard), what="what the clone says")
    assert first.of(DigestHeard)[0].digest == second.digest()
    first.presence.send_state(first.state(number=5))
    second.presence.ask_state("r1", tag(first.zid))
    wait_until(lambda: second.of(StateHeard), what="the answer of the one that was asked")
    assert {event.state.zid for event in second.of(StateHeard)} == {first.zid}
