"""What is learnt of another robot from its digests and samples."""

from dataclasses import replace

from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import Digest, State, StreamDigest, StreamState, tag
from proxy.core.view.peer import Peer
from proxy.core.view.tuning import TUNING
from proxy.core.view.view import SharedView
from tests.proxy.core.view.met import CAMERA, digest, meet


def test_an_update_changes_only_the_streams_it_names(view):
    """One of another state than ours is not taken in."""
    meet(view, number=4, subscriptions=("robot/**",))
    update = State("r2", "z-r2", "", "", (StreamState(9, "robot/r2b/camera", "camera", 0.25),), number=5, since=4)
    assert view.heard_state(1.0, update)
    peer = view.peers["z-r2"]
    assert (peer.state.number, peer.keys[7], peer.keys[9], peer.state.subscriptions) == (
        5,
        CAMERA,
        "robot/r2b/camera",
        ("robot/**",),
    )
    assert not view.heard_state(1.0, State("r2", "z-r2", "", "", (), number=9, since=8))
    crowd = tuple(StreamState(100 + n, f"k{n}", "camera", 0.5) for n in range(4096))
    assert not view.heard_state(1.0, State("r2", "z-r2", "", "", crowd, number=6, since=5))
    assert peer.state.number == 5


def test_of_two_states_of_one_number_that_differ_one_is_forged():
    """Then nobody knows what its clock is wrong by; a state of another number says so."""
    peer, state = Peer("r2", "z-r2", 0.0), State("r2", "z-r2", "", "", wall_offset=5.0, number=3, clock_error=0.01)
    peer.take_state(1.0, state)
    assert peer.clock_error == 0.01
    peer.take_state(2.0, replace(state, wall_offset=9.0))
    assert (peer.clock_error, peer.inbound.wall_offset) == (0.0, 9.0)
    peer.take_state(3.0, replace(state, wall_offset=9.0, number=4))
    assert peer.clock_error == 0.01


def test_an_announcement_does_not_say_how_much_its_robot_sent():
    """The next one has to follow it all the same."""
    peer = Peer("r2", "z-r2", 0.0)
    peer.heard_digest(1.0, Digest("r2", "z-r2", 1.0, 7, 700))
    peer.heard_digest(2.0, Digest("r2", "z-r2", 2.0, brief=True))
    assert (peer.counted, peer.digest.sent, peer.digest_received) == ((1.0, 7, 700), 2.0, 2.0)
    peer.restart()
    assert peer.digest is None


def test_news_without_a_key_is_bounded(view):
    """Numbers that no state explains."""
    view.add_peer(0.0, "r2", "z-r2")
    news = tuple(StreamDigest(n, 1, 0, 1.0, 0.0, 10, 1.0) for n in range(1030))
    view.heard_digest(1.0, digest(1.0, *news))
    assert (len(view.peers["z-r2"].pending), view.peers["z-r2"].evicted) == (1024, 6)


def test_news_without_a_key_counts_once_however_many_there_are(view):
    """Also where it is told again after it had to make room; one with a new number is another one."""
    view.add_peer(0.0, "r2", "z-r2")
    many = TUNING.pending_news + 100
    for at in (1.0, 2.0, 3.0):
        view.heard_digest(at, digest(at, *(StreamDigest(n, 1, 1, 1.0, 1.0, 10, 1.0) for n in range(many))))
        assert len(view.traffic.sends) == many
    view.heard_digest(4.0, digest(4.0, StreamDigest(many, 1, 1, 4.0, 4.0, 10, 1.0)))
    assert len(view.traffic.sends) == many + 1
    view.heard_digest(5.0, digest(5.0, StreamDigest(many, 2, 2, 5.0, 5.0, 10, 1.0)))
    assert len(view.traffic.sends) == many + 2


def test_news_without_a_key_that_is_heard_of_no_more_makes_room(view):
    """Keys that are gone by the next state are never named: what a new stream sent did not count once 1,024 were."""
    view.add_peer(0.0, "r2", "z-r2")

    def news(number):
        return StreamDigest(number, 1, 1, 1.0, 1.0, 10, 1.0)

    view.heard_digest(1.0, digest(1.0, *map(news, range(1024))))
    view.heard_digest(1.1, digest(1.1, news(0)))
    view.heard_digest(1.2, digest(1.2, news(5000)))
    assert len(view.traffic.sends) == 1025
    streams = tuple(StreamState(number, f"robot/r2/{number}/camera", "camera", 0.5) for number in (0, 1, 5000))
    view.heard_state(1.3, State("r2", "z-r2", "enforce", "", streams))
    assert len(view.peers["z-r2"].pending) == 1022


def test_how_long_a_stream_is_silent_tells_when_its_robot_spoke_not_when_that_came(make_specs):
    """Where news take longer than a stream may be silent none is over for it."""
    view = SharedView(CoreSettings("r1", "z-r1"), make_specs())
    view.subscribers.set_own(("robot/**",))
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", (StreamState(1, CAMERA, "camera", 0.1),)))
    view.heard_digest(0.5, Digest("r2", "z-r2", 0.5))
    for count in range(1, 40):
        sent = 0.5 + 0.1 * count
        news = StreamDigest(1, count, count, sent, sent, 100, 1.0, (), 0.1)
        view.heard_digest(sent + 3.0, Digest("r2", "z-r2", sent, streams=(news,)))
    assert view.contention.competes(sent + 3.0, view.streams.known("r2", CAMERA))
    view.heard_digest(sent + 5.0, Digest("r2", "z-r2", sent + 1.9))
    assert not view.contention.competes(sent + 5.0, view.streams.known("r2", CAMERA))


def test_a_digest_of_parts_alone_does_not_tell_that_streams_are_silent(view):
    """It names no stream: after a minute of such ones each robot found itself alone."""
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_digest(
        1.0, Digest("r2", tag("z-r2"), 0.9, messages=3, streams=(StreamDigest(1, 3, 3, 0.5, 0.5, 100, 1.0),))
    )
    told = view.staleness.told_until("r2")
    view.heard_digest(2.0, Digest("r2", tag("z-r2"), 1.9, messages=5, partial=True))
    assert view.staleness.told_until("r2") == told
    view.heard_digest(3.0, Digest("r2", tag("z-r2"), 2.9, messages=5))
    assert view.staleness.told_until("r2") > told


def test_an_announcement_does_not_tell_that_other_streams_are_silent(view):
    """It leaves out what is small."""
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_digest(1.0, Digest("r2", tag("z-r2"), 0.9))
    told = view.staleness.told_until("r2")
    view.heard_digest(2.0, Digest("r2", tag("z-r2"), 1.9, brief=True))
    assert view.staleness.told_until("r2") == told
    view.heard_digest(3.0, Digest("r2", tag("z-r2"), 2.9))
    assert view.staleness.told_until("r2") > told
