"""What daemons tell each other beside the data, on real sessions."""

import pytest
import zenoh

from proxy.bridge import keys
from proxy.bridge.demand import Demand
from proxy.bridge.lane import Lane
from proxy.bridge.presence import Presence, free_name
from proxy.core.codec import pack_digest
from proxy.core.events import DigestHeard, MalformedHeard, PeerAppeared, PeerGone, StateHeard
from proxy.core.wire import Digest, State, tag
from tests.proxy.nodes import Heard, closing, free_endpoint, plain_session
from tests.waiting import wait_until


class Voiced:
    """A robot that only speaks for itself. Functions that make events are run as the loop would."""

    def __init__(self, stack, robot, connect=()):
        self.endpoint = free_endpoint()
        self.mesh = closing(stack, plain_session("peer", listen=(self.endpoint,), connect=connect))
        self.zid = str(self.mesh.zid())
        self.robot = robot
        self.events = []
        lane = Lane("test")
        stack.callback(lane.close, 1.0)
        self.demand = Demand(self.mesh, lambda _: None, lambda: None)
        self.presence = Presence(self.mesh, robot, lane, self._post, self.demand)
        stack.callback(self.presence.close)

    def _post(self, item):
        event = item() if callable(item) else item
        if event is not None:
            self.events.append(event)

    def of(self, kind):
        return [event for event in list(self.events) if isinstance(event, kind)]

    def digest(self, **changes):
        told = {"robot": self.robot, "tag": tag(self.zid), "sent": 1.0, "epoch": 1, "messages": 3, "bytes": 4}
        return Digest(**told | changes)

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


def test_a_newcomer_fetches_the_state_that_was_published_before(stack):
    """A state published to nobody is known to a robot that comes later, with what its apps subscribe to."""
    first = Voiced(stack, "r1")
    first.presence.open()
    first.presence.send_state(first.state(subscriptions=("a/*",)))
    second = Voiced(stack, "r2", (first.endpoint,))
    second.presence.open()
    wait_until(lambda: second.of(StateHeard), what="the state")
    assert second.of(StateHeard)[0].state == first.state(subscriptions=("a/*",))
    second.demand.told("z9", ["a/b"])
    assert second.demand.copies("a/b") == 2


def test_a_changed_state_is_published(two):
    """Those who are there learn of a change without asking."""
    first, second = two
    first.presence.send_state(first.state(mode="shadow"))
    wait_until(lambda: second.of(StateHeard), what="the state")
    assert second.of(StateHeard)[-1].state.mode == "shadow"


def test_malformed_and_forged_messages_are_counted_as_such(stack, two):
    """Garbage, and digests and states that name another robot than their key, change nothing."""
    first, _ = two
    hostile = closing(stack, plain_session("peer", connect=(first.endpoint,)))
    probe = hostile.declare_publisher(keys.digest("r9"))
    wait_until(lambda: probe.matching_status.matching, what="the link")
    probe.put(b"garbage")
    hostile.put(keys.state("r9"), b"\xff" * 100, congestion_control=zenoh.CongestionControl.BLOCK)
    forged = pack_digest(Digest("r2", tag("z2"), 1.0, 1, 1, 1))
    hostile.put(keys.digest("r9"), forged, congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: len(first.of(MalformedHeard)) == 3, what="three malformed messages")
    assert {event.robot for event in first.of(MalformedHeard)} == {"r9"}
    assert not first.of(DigestHeard)


def test_a_name_that_is_taken_is_said_loudly_by_both(stack, caplog):
    """The newcomer runs under another name; if it insists, the older one says so and does not believe it."""
    first = Voiced(stack, "r1")
    first.presence.open()
    second = Voiced(stack, "r1", (first.endpoint,))
    wait_until(second.mesh.info.peers_zid, what="the link")
    name = []
    wait_until(lambda: name.append(free_name(second.mesh, "r1")) or name[-1] != "r1", what="the other to be seen")
    assert name[-1] == f"r1-{second.zid[:4]}"
    assert f"runs as '{name[-1]}'" in caplog.text
    assert free_name(second.mesh, "r7") == "r7"
    second.presence.open()
    second.presence.send_digest(second.digest())
    wait_until(lambda: f"is called 'r1' too (session {second.zid})" in caplog.text, what="the older one's line")
    assert not first.of(PeerAppeared)
    assert not first.of(DigestHeard)


def test_a_closed_session_is_an_error_in_the_log(stack, caplog):
    """A digest that cannot be published is said, and ends nothing."""
    first = Voiced(stack, "r1")
    first.mesh.close()
    first.presence.send_digest(first.digest())
    assert "cannot publish on @sendworthy/r1/digest" in caplog.text
