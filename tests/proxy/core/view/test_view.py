"""The shared view: streams, peers, origins, bounded."""

import math
from dataclasses import replace

import pytest

from planner import Video
from proxy.core.interface.events import SampleHeard
from proxy.core.model.settings import CoreSettings
from proxy.core.model.transport import UNICAST, broadcast
from proxy.core.protocol.messages import Digest, Echo, State, StreamDigest, StreamState, tag
from proxy.core.view.interest import intersects
from proxy.core.view.stream import Generated, Sent, Stream
from proxy.core.view.tuning import TUNING
from proxy.core.view.view import SharedView

CAMERA = "robot/r2/camera"
ONCE = """
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
aggregation = "once"
utility = { kind = "video" }
"""


@pytest.fixture
def view(make_specs):
    return SharedView(CoreSettings("r1", "z-r1", streams=3), make_specs())


def digest(sent, *streams, echoes=()):
    return Digest("r2", "z-r2", sent, 0, 0, streams, echoes)


def meet(view, **rest):
    """Robot r2 is there and told us of its camera, number 7."""
    view.add_peer(0.0, "r2", "z-r2")
    streams = (StreamState(7, CAMERA, "camera", 0.5), StreamState(8, "other/key", "x", 0.5))
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", streams, **rest))


def test_news_of_a_stream_is_read_on_our_clock(view):
    """The sender's times pass through its clock offset."""
    meet(view)
    assert view.heard_digest(100.0, digest(5.0, StreamDigest(7, 3, 1, 4.9, 4.5, 1000, 2.0)))
    (stream,) = view.streams
    assert stream.last == Generated(pytest.approx(99.9), 1000, 2.0)
    assert stream.sent == Sent(pytest.approx(99.5), pytest.approx(99.5), 1000, 2.0)
    assert stream.schedule.forecast(99.9, 100.5, 5) == pytest.approx([100.4])


def test_news_of_a_number_waits_for_its_key(view):
    """Digests may arrive before the state that names their streams."""
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_digest(1.0, digest(1.0, StreamDigest(7, 1, 0, 1.0, 0.0, 10, 1.0)))
    assert list(view.streams) == []
    meet(view)
    assert [stream.key for stream in view.streams] == [CAMERA]


def test_what_was_sent_of_a_number_without_a_key_counts_once(view):
    """Before the state that names it, and not twice after that; what is told again is no other sample."""
    view.add_peer(0.0, "r2", "z-r2")
    for at, forwarded, size in ((1.0, 0, 10), (1.1, 1, 10), (1.2, 1, 10), (1.3, 2, 30)):
        view.heard_digest(at, digest(at, StreamDigest(7, 4, forwarded, at, at, size, 1.0)))
    view.heard_digest(1.4, digest(1.4, StreamDigest(8, 1, 1, 1.4, 1.4, 0, 1.0)))
    assert view.traffic.sent_since(0.0) == [(1.1, (10, 1)), (1.3, (30, 1))]
    view.subscribers.set_own(("**",))
    meet(view)
    assert sorted(view.traffic.sent_since(0.0)) == [(1.1, (10, 1)), (1.3, (30, 1))]


def test_what_is_heard_from_the_air_counts_by_that(make_specs):
    """However late it is named."""
    view = SharedView(CoreSettings("r1", "z-r1", transport=broadcast("g")), make_specs())
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", (), transport=broadcast("g")))
    view.heard_digest(1.0, digest(1.0, StreamDigest(7, 1, 1, 1.0, 1.0, 10, 1.0)))
    assert view.traffic.sent_since(0.0) == []


def test_a_robot_that_told_nothing_yet_may_want_everything(view):
    """Zenoh sends it a copy as soon as it is linked; who takes no part is a plain node, and costs nothing here."""
    own = view.streams.touch(0.0, "r1", "robot/r1/camera")
    meet(view, subscriptions=(own.key,))
    assert view.subscribers.copies(own) == 1
    view.add_peer(1.0, "r3", "z-r3")
    view.add_peer(1.0, "r4", "z-r4")
    assert (view.subscribers.count(own), view.subscribers.copies(own)) == (1, 3)
    assert view.subscribers.copies(view.streams.touch(1.0, "r3", "robot/r3/camera")) == 1
    view.heard_state(1.1, State("r3", "z-r3", "enforce", ""))
    assert view.subscribers.copies(own) == 2
    view.peers[tag("z-r4")].take_part(plain=True)
    assert view.subscribers.copies(own) == 1
    view.add_peer(2.0, "r5", "z-r5")
    view.gone("z-r5")
    assert view.subscribers.copies(own) == 1


@pytest.mark.parametrize("sent", [1.0, 0.5])
def test_a_digest_heard_twice_or_late_changes_nothing(view, sent):
    """Replays and reordering are harmless."""
    meet(view)
    assert view.heard_digest(1.0, digest(1.0))
    assert not view.heard_digest(2.0, digest(sent, StreamDigest(7, 9, 9, 1.0, 1.0, 10, 1.0)))
    assert list(view.streams) == []


def test_strangers_are_not_listened_to(view):
    """A digest or a state of a robot without a presence token changes nothing."""
    assert not view.heard_digest(1.0, digest(1.0))
    view.heard_state(1.0, State("r2", "z-r2", "enforce", ""))
    assert view.peers == {}
    assert view.add_peer(0.0, "r2", "z-r2")
    assert not view.add_peer(0.0, "r2", "z-r2")


def test_echoes_give_offset_and_latency(view):
    """What the peer says of our digest and our samples is kept."""
    meet(view)
    echo = Echo("z-r1", 9.0, -90.9, 12, 0.25)
    view.heard_digest(10.1, digest(-90.0, echoes=(echo, Echo("z-xx", 0.0, 0.0, 0, 0.0))))
    peer = view.peers["z-r2"]
    assert peer.offset.offset == pytest.approx(100.0, abs=1e-3)
    assert peer.offset.latency == pytest.approx(0.1)
    assert (peer.outbound.received, view.paths.of("r1").mean.of(0.0)) == (12, 0.25)
    assert view.paths.of("r2").mean.of(0.0) == pytest.approx(0.1)
    assert view.paths.of("unknown").mean.of(0.0) == 0.0
    (back,) = view.echoes.due(3.0)
    assert (back.peer, back.sent, back.received) == ("z-r2", -90.0, 10.1)


def test_samples_of_a_peer_are_counted_for_it(view):
    """With the last digest we tell how many had come by then; without a digest we know nobody."""
    meet(view)
    view.overhearing.take(SampleHeard(4.0, CAMERA, 100, "z-r2", None, None))
    view.heard_digest(5.0, digest(5.0))
    view.overhearing.take(SampleHeard(6.3, CAMERA, 100, "z-r2", None, None))
    assert [echo.samples for echo in view.echoes.due(3.0)] == [0]
    view.heard_digest(7.0, digest(7.0))
    assert [echo.samples for echo in view.echoes.due(3.0)] == [1]
    view.add_peer(11.0, "r3", "z-r3")
    assert [echo.peer for echo in view.echoes.due(11.0)] == ["z-r2"]


def test_the_quickest_digest_since_the_last_echo_tells_most_of_clocks(view):
    """Others waited somewhere; what came long ago says less, as clocks drift."""
    meet(view)
    for sent, took in ((5.0, 0.3), (6.0, 0.02), (7.0, 0.2)):
        view.heard_digest(sent + took, digest(sent))
    assert [echo.sent for echo in view.echoes.due(8.0)] == [7.0]
    assert [echo.sent for echo in view.echoes.due(8.0, quickest=True)] == [6.0]
    view.echoes.sent(["z-r2"])
    assert [echo.sent for echo in view.echoes.due(8.0, quickest=True)] == [7.0]
    view.heard_digest(9.1, digest(9.0))
    view.heard_digest(1009.2, digest(1009.0))
    assert [echo.sent for echo in view.echoes.due(1010.0, quickest=True)] == [1009.0]


def test_in_a_large_team_who_has_just_met_is_not_echoed(view):
    """Its digests wait while it starts."""
    meet(view)
    for number in range(TUNING.peers_always_echoed):
        view.add_peer(10.0, f"r{number + 3}", f"z-r{number + 3}")
    for name, now in (("r2", 10.1), ("r3", 10.2)):
        view.heard_digest(now, Digest(name, tag(f"z-{name}"), now))
    assert [echo.peer for echo in view.echoes.due(10.5)] == [tag("z-r2")]
    assert [echo.peer for echo in view.echoes.due(10.0 + TUNING.unechoed_after_meeting)] == [tag("z-r2"), tag("z-r3")]


def test_who_knows_no_way_yet_is_echoed_first(view):
    """By what all echo, so that soon everybody knows one; of equal ones each robot begins with another one."""
    for name in ("r0", "r2", "r3"):
        view.add_peer(0.0, name, f"z-{name}")
    assert not view.echoes.are_awaited(3.0)
    for name in ("r0", "r2", "r3"):
        view.heard_digest(1.0, Digest(name, tag(f"z-{name}"), 1.0))
    assert [echo.peer for echo in view.echoes.due(3.0)] == [tag("z-r2"), tag("z-r3"), tag("z-r0")]
    view.heard_digest(3.0, Digest("r3", tag("z-r3"), 3.0, echoes=(Echo(tag("z-r2"), 1.0, 1.0, 0, 0.0),)))
    assert [echo.peer for echo in view.echoes.due(3.0)] == [tag("z-r3"), tag("z-r0"), tag("z-r2")]
    assert view.echoes.are_awaited(3.0)
    view.echoes.sent([tag("z-r3"), tag("z-r0")])
    assert not view.echoes.are_awaited(3.0)


def test_ways_that_nobody_echoed_are_taken_to_be_as_long_as_the_shortest_one_known(view):
    """What others sent was sent before it was heard of, and what they send takes as long."""
    for name in ("r2", "r3", "r4"):
        view.add_peer(0.0, name, f"z-{name}")
    for name, took in (("r2", 0.1), ("r3", 0.3)):
        echo = Echo("z-r1", 9.0, 9.0 + took, 0, 0.0)
        view.heard_digest(10.0, Digest(name, tag(f"z-{name}"), 10.0 - took, echoes=(echo,)))
    view.heard_digest(10.0, Digest("r4", tag("z-r4"), 10.0))
    view.add_peer(10.0, "r5", "z-r5")
    ways = {peer.robot: (peer.offset.latency, peer.offset.known) for peer in view.peers.values()}
    assert ways["r4"] == ways["r5"] == (pytest.approx(0.1), False)
    assert ways["r3"] == (pytest.approx(0.3), True)
    assert view.peers[tag("z-r4")].offset.ours(10.0) == pytest.approx(9.9)
    assert view.paths.of("r4").mean.of(0.0) == pytest.approx(0.1)


def test_a_plain_node_is_estimated_from_what_is_heard(view):
    """Its id is no robot's, so every sample of it counts as generated and sent."""
    for now in (1.0, 1.5, 2.0):
        view.overhearing.take(SampleHeard(now, "robot/plain/camera", 100, "feed", None, None))
    view.overhearing.take(SampleHeard(2.0, "no/spec", 100, "feed", None, None))
    (stream,) = view.streams
    assert (stream.robot, stream.generated, stream.forwarded) == ("?feed", 3, 3)
    assert stream.schedule.period == pytest.approx(0.5)


def test_an_origin_belongs_to_the_robot_whose_app_side_it_entered(view):
    """Apps that stamp carry their own ids; what another robot claims is never ours."""
    meet(view, origins=("app-2",))
    assert view.origins.robot_of(None) == view.origins.robot_of("z-r1") == "r1"
    assert view.origins.robot_of("app-2") == view.origins.robot_of("z-r2") == "r2"
    assert view.origins.robot_of("app-1") == "?app-1"
    assert view.origins.claim("app-1")
    assert not view.origins.claim("app-1")
    assert not view.origins.claim("app-2")
    assert view.origins.robot_of("app-1") == "r1"


def test_origins_are_bounded(view):
    """The oldest claim is forgotten, never our own id."""
    for number in range(300):
        view.origins.claim(f"app-{number}")
    assert len(view.origins.own) == 256
    assert view.origins.robot_of("z-r1") == "r1"
    assert view.evicted == 300 - 255


def test_receivers_are_the_robots_that_subscribe(view):
    """Our own apps count for others' streams, Zenoh's matching for a plain node that wants ours."""
    own = view.streams.touch(0.0, "r1", "robot/r1/camera")
    assert view.subscribers.count(own) == 0
    own.matching = True
    assert view.subscribers.count(own) == 1
    view.add_peer(0.0, "r3", "z-r3")
    view.heard_state(0.0, State("r3", "z-r3", "enforce", "", (), ("robot/**",)))
    meet(view, subscriptions=("robot/*/camera", "robot/r1/**"))
    assert view.subscribers.count(own) == 2
    others = view.streams.touch(0.0, "r2", CAMERA)
    assert view.subscribers.count(others) == 1
    view.subscribers.set_own(("robot/r2/*",))
    assert (view.subscribers.count(others), view.subscribers.copies(others)) == (2, 2)


def test_what_a_router_relays_costs_the_way_to_it_and_to_each_robot(make_specs):
    """Nobody but a plain node behind the router: the way to it. Each robot that wants the stream: one copy more."""
    view = SharedView(CoreSettings("r1", "z-r1", relayed=True), make_specs())
    own = view.streams.touch(0.0, "r1", "robot/r1/camera")
    own.matching = True
    assert (view.subscribers.count(own), view.subscribers.copies(own)) == (1, 1)
    meet(view, subscriptions=("robot/*/camera",))
    assert (view.subscribers.count(own), view.subscribers.copies(own)) == (1, 2)


def test_who_did_not_say_yet_what_it_wants_counts_for_what_we_send_alone(make_specs):
    """What others send goes to those of whom we know that they want it: they have known them for longer."""
    view = SharedView(CoreSettings("r1", "z-r1"), make_specs())
    meet(view, subscriptions=("robot/*/camera",))
    own, others = view.streams.touch(0.0, "r1", "robot/r1/camera"), view.streams.touch(0.0, "r3", "robot/r3/camera")
    view.add_peer(0.0, "r3", "z-r3")
    view.add_peer(0.0, "r4", "z-r4")
    assert (view.subscribers.copies(own), view.subscribers.copies(others)) == (3, 1)


def test_who_has_just_been_met_may_say_for_a_moment_what_it_sent_lately(make_specs):
    """Until it has, or that is over; who has no streams has nothing to say."""
    view = SharedView(CoreSettings("r1", "z-r1"), make_specs())
    assert view.newcomers.greeted_by(1.0) == -math.inf
    view.add_peer(1.0, "r2", "z-r2")
    view.add_peer(1.1, "r3", "z-r3")
    assert view.newcomers.greeted_by(1.1) == 1.1 + TUNING.greeting_time
    view.heard_state(1.1, State("r3", "z-r3", "enforce", ""))
    assert view.newcomers.greeted_by(1.1) == 1.0 + TUNING.greeting_time
    view.heard_digest(1.2, Digest("r2", "z-r2", 1.2))
    assert view.newcomers.greeted_by(1.2) == -math.inf
    view.add_peer(2.0, "r4", "z-r4")
    assert view.newcomers.greeted_by(2.0 + TUNING.greeting_time) == -math.inf


def test_of_once_only_those_gain_that_were_sent_nothing_yet(make_specs):
    """Whoever joins later gets its first; one that left and is back, too. Own and others' streams alike."""
    view = SharedView(CoreSettings("r1", "z-r1"), make_specs(text=ONCE))
    meet(view, subscriptions=("robot/**",))
    own = view.streams.touch(0.0, "r1", "robot/r1/camera")
    own.note_generated(1, Generated(0.0, 10, 1.0))
    assert (view.subscribers.gaining(own), view.contention.competes(1.0, own)) == (("z-r2",), True)
    view.traffic.note_sent(own, 1, Sent(1.0, 1.0, 10, 1.0))
    assert (view.subscribers.gaining(own), view.subscribers.count(own), view.contention.competes(1.0, own)) == (
        (),
        1,
        False,
    )
    view.add_peer(2.0, "r3", "z-r3")
    view.heard_state(2.0, State("r3", "z-r3", "enforce", "", (), ("robot/**",)))
    assert view.subscribers.gaining(own) == ("z-r3",)
    view.gone("z-r2")
    meet(view, subscriptions=("robot/**",))
    assert set(view.subscribers.gaining(own)) == {"z-r2", "z-r3"}
    view.heard_digest(3.0, digest(3.0, StreamDigest(7, 2, 1, 2.9, 2.5, 10, 1.0)))
    others = view.streams.touch(3.0, "r2", CAMERA)
    assert (view.subscribers.of(others), view.subscribers.gaining(others)) == (("z-r3",), ())


def test_a_plain_node_that_was_sent_something_gains_no_more_of_it(make_specs):
    """It has no name, so all such nodes are one."""
    view = SharedView(CoreSettings("r1", "z-r1"), make_specs(text=ONCE))
    own = view.streams.touch(0.0, "r1", "robot/r1/camera")
    own.matching = True
    assert view.subscribers.gaining(own) == ("",)
    view.traffic.note_sent(own, 1, Sent(1.0, 1.0, 10, 1.0))
    assert view.subscribers.gaining(own) == ()


def test_an_invalid_subscription_matches_nothing():
    """What a peer says is not trusted to be a key expression."""
    assert not intersects("a//b", "a/b")
    assert intersects("a/*", "a/b")


def test_a_stream_that_ended_takes_no_part(view):
    """After ten seconds, or five periods, without news."""
    stream = view.streams.touch(0.0, "r1", "robot/r1/camera")
    stream.matching = True
    assert not view.contention.competes(0.0, stream)
    stream.note_generated(1, Generated(0.0, 10, 1.0))
    assert view.contention.competes(9.0, stream)
    assert not view.contention.competes(11.0, stream)
    stream.note_generated(2, Generated(20.0, 10, 1.0))
    assert view.contention.competes(100.0, stream)


def test_specs_are_swapped_whole(view, make_specs):
    """Streams keep what was observed under their new type, or leave."""
    stream = view.streams.touch(0.0, "r1", "robot/r1/camera")
    stream.note_generated(1, Generated(0.0, 10, 1.0))
    view.streams.set_specs(make_specs(limit="1 Mbit/s"))
    assert next(iter(view.streams)).generated == 1
    assert next(iter(view.streams)).information_type.utility == Video()
    text = '[[information_type]]\nname = "x"\nkeys = ["x"]\naggregation = "most_recent"\nutility = { kind = "video" }\n'
    view.streams.set_specs(make_specs(text=text))
    assert list(view.streams) == []


def test_a_robot_that_restarted_has_its_name_when_its_old_self_leaves(view):
    """The old presence token vanishes after the new one appeared; the new one's streams count anew."""
    meet(view)
    view.heard_digest(1.0, digest(1.0, StreamDigest(7, 9, 9, 1.0, 1.0, 10, 1.0)))
    view.add_peer(2.0, "r2", "z-new")
    assert [peer.robot for peer in view.peers.values()] == ["r2", "r2-z-ne"]
    view.heard_state(2.0, State("r2", "z-new", "enforce", "", (StreamState(7, CAMERA, "camera", 0.5),)))
    view.heard_digest(2.0, Digest("r2", "z-new", 1.0, 0, 0, (StreamDigest(7, 1, 1, 1.0, 1.0, 10, 1.0),)))
    view.gone("z-r2")
    assert [(stream.robot, stream.generated) for stream in view.streams] == [("r2", 1)]
    assert view.members.namesakes() == []
    view.gone("z-new")
    assert list(view.streams) == []
    view.gone("z-new")


def test_sends_nobody_told_us_of_are_spread_evenly():
    """A lost digest leaves a gap in the counts, not in what the air carried."""
    stream = Stream(1, "r2", CAMERA, None)
    stream.note_sent(1, Sent(1.0, 1.0, 10, 1.0))
    stream.note_sent(4, Sent(4.0, 4.0, 10, 1.0))
    assert [sent.t_sent for sent in stream.recent] == [1.0, 2.0, 3.0, 4.0]
    assert stream.mean_interval == 1.0
    stream.note_sent(2, Sent(9.0, 9.0, 10, 1.0))
    assert stream.forwarded == 4
    stream.note_generated(0, Generated(1.0, 1, 1.0))
    with pytest.raises(LookupError, match="nothing was generated"):
        _ = stream.newest


def test_a_broadcast_sample_is_one_copy_for_all(make_specs):
    """How many want it does not matter; each robot's samples cost what its own transport makes of them."""
    group = broadcast("224.0.0.226:7449")
    view = SharedView(CoreSettings("r1", "z-r1", transport=group), make_specs())
    for robot, transport in (("r2", UNICAST), ("r3", group), ("r4", group)):
        view.add_peer(0.0, robot, f"z-{robot}")
        state = State(robot, f"z-{robot}", "enforce", "", (), ("robot/*/camera",), transport=transport)
        view.heard_state(0.0, state)
    streams = {robot: view.streams.touch(0.0, robot, f"robot/{robot}/camera") for robot in ("r1", "r2", "r3")}
    assert {robot: view.subscribers.count(stream) for robot, stream in streams.items()} == {"r1": 3, "r2": 2, "r3": 2}
    assert {robot: view.subscribers.copies(stream) for robot, stream in streams.items()} == {"r1": 1, "r2": 2, "r3": 1}
    view.gone("z-r3")
    assert view.subscribers.copies(view.streams.touch(1.0, "r3", "robot/r3/camera")) == 2


def test_how_long_a_stream_is_silent_tells_when_its_robot_spoke_not_when_that_came(make_specs):
    """Where news take as long as ten periods no stream is over for it."""
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


def test_an_announcement_does_not_tell_that_other_streams_are_silent(view):
    """It leaves out what is small."""
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_digest(1.0, Digest("r2", tag("z-r2"), 0.9))
    told = view.staleness.reported_until("r2", math.inf)
    view.heard_digest(2.0, Digest("r2", tag("z-r2"), 1.9, brief=True))
    assert view.staleness.reported_until("r2", math.inf) == told
    view.heard_digest(3.0, Digest("r2", tag("z-r2"), 2.9))
    assert view.staleness.reported_until("r2", math.inf) > told


def test_an_overheard_sample_counts_as_sent_and_leaves_its_number_to_the_digest(make_specs):
    """A number guessed too high would hide the right one; that the sample was sent is known at once, and once only."""
    view = SharedView(CoreSettings("r1", "z-r1", transport="udp/224.0.0.226:7449"), make_specs())
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", (StreamState(1, CAMERA, "camera", 1.0),)))
    name = next(iter(view.peers))

    def news(now, generated, forwarded):
        told = StreamDigest(1, generated, forwarded, now - 0.01, now - 0.01, 100, 1.0)
        view.heard_digest(now, Digest("r2", name, now - 0.01, 0, 0, (told,)))

    news(1.0, 1, 1)
    news(2.0, 2, 2)
    view.overhearing.take(SampleHeard(5.6, CAMERA, 100, "z-r2", None, None))
    stream = view.streams.known("r2", CAMERA)
    assert (stream.generated, stream.forwarded) == (2, 3)
    news(5.61, 5, 3)
    assert (stream.generated, stream.forwarded) == (5, 3)
    assert len(view.traffic.sent_since(5.0)) == 1


@pytest.mark.parametrize("told_at", [5.0, 5.6])
def test_a_stream_is_known_from_the_air_before_any_digest_tells_of_it(make_specs, told_at):
    """What it sent before nobody knows; what was heard and what is told of it then counts once."""
    view = SharedView(CoreSettings("r1", "z-r1", transport="udp/224.0.0.226:7449"), make_specs())
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", (StreamState(1, CAMERA, "camera", 0.6),)))
    name = next(iter(view.peers))
    view.heard_digest(1.0, Digest("r2", name, 0.99))
    view.overhearing.take(SampleHeard(5.0, CAMERA, 100, "z-r2", None, None))
    view.overhearing.take(SampleHeard(5.0, "no/spec", 100, "z-r2", None, None))
    stream = view.streams.known("r2", CAMERA)
    assert (stream.generated, stream.forwarded, stream.period) == (1, 1, 0.6)
    told = StreamDigest(1, 80, 40, told_at - 0.01, told_at - 0.01, 100, 1.0)
    view.heard_digest(told_at + 0.02, Digest("r2", name, told_at + 0.01, 0, 0, (told,)))
    assert (stream.generated, stream.forwarded) == (80, 40)
    assert len(view.traffic.sent_since(4.0)) == (2 if told_at == 5.0 else 3)


PYTHON = """
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
utility = { kind = "python", function = "tests.utility_specs.worths:by_red" }
features.red = { kind = "color_fraction", color = "red" }
"""


def test_how_a_stream_generates_its_robot_knows_best(view):
    """Of a random stream the next is expected from now on, though the samples we know of seem regular."""
    view.add_peer(0.0, "r2", "z-r2")
    streams = (StreamState(7, CAMERA, "camera", 4.0, schedule="poisson"),)
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", streams))
    for k in range(1, 5):
        view.heard_digest(100.0 + k, digest(5.0 + k, StreamDigest(7, k, 0, 5.0 + k, 0.0, 1000, 2.0)))
    (stream,) = view.streams
    assert stream.schedule.kind == "poisson"
    assert stream.schedule.forecast(104.0, 112.0, 5, 105.0) == [109.0]


def test_nothing_was_generated_in_the_future(view):
    """Whatever a peer's clock says, a sample is no newer than the news of it."""
    meet(view)
    view.heard_digest(100.0, digest(5.0, StreamDigest(7, 3, 0, 9.0, 0.0, 1000, 2.0)))
    (stream,) = view.streams
    assert stream.last.t_gen == 100.0


def test_features_that_others_need_are_read_by_name(make_specs):
    """As many as the type has; others tell of another spec."""
    view = SharedView(CoreSettings("r1", "z-r1"), make_specs(text=PYTHON))
    meet(view)
    view.heard_digest(100.0, digest(5.0, StreamDigest(7, 3, 1, 4.9, 4.5, 1000, 2.0, (0.5,))))
    (stream,) = view.streams
    assert stream.last.features == stream.sent.features == {"red": 0.5}
    view.heard_digest(101.0, digest(6.0, StreamDigest(7, 4, 1, 5.9, 4.5, 1000, 2.0, (0.5, 0.7))))
    assert stream.last.features == {}


def test_a_stream_that_is_silent_for_long_by_its_own_measure_competes_no_more(view):
    """As far as its robot's news tell: while there are none, it may well go on."""
    meet(view)
    view.subscribers.set_own(("**",))
    for k in range(1, 12):
        view.heard_digest(100.0 + 0.1 * k, digest(5.0 + 0.1 * k, StreamDigest(7, k, 0, 5.0 + 0.1 * k, 0.0, 10, 2.0)))
    (stream,) = view.streams
    assert view.contention.competes(130.0, stream)
    view.heard_digest(101.8, digest(6.8))
    assert view.contention.competes(130.0, stream)
    view.heard_digest(102.2, digest(7.2))
    assert not view.contention.competes(102.2, stream)
    view.gone("z-r2")
    assert list(view.streams) == []


def test_robots_of_one_name_are_told_apart(view):
    """Three clones and one of our own name: each has its streams, tags and claims; the plain name is inherited."""
    for zid in ("aaaa1", "aaaa2", "bbbb1"):
        assert view.add_peer(0.0, "r2", zid)
        view.heard_state(0.0, State("r2", zid, "", "", (StreamState(7, CAMERA, "camera", 0.5),), ("robot/**",)))
    view.add_peer(0.0, "r1", "cccc1")
    assert [peer.robot for peer in view.peers.values()] == ["r2", "r2-aaaa", "r2-bbbb", "r1-cccc"]
    assert [peer.name for peer in view.members.namesakes()] == ["r2", "r2", "r1"]
    for number, zid in enumerate(("aaaa1", "aaaa2", "bbbb1"), 1):
        view.heard_digest(1.0, Digest("r2", zid, 1.0, 0, 0, (StreamDigest(7, number, 0, 1.0, 0.0, 10, 1.0),)))
    assert {s.robot: s.generated for s in view.streams} == {"r2": 1, "r2-aaaa": 2, "r2-bbbb": 3}
    assert view.members.tags == {
        "r1": "z-r1",
        "r2": "aaaa1",
        "r2-aaaa": "aaaa2",
        "r2-bbbb": "bbbb1",
        "r1-cccc": "cccc1",
    }
    assert view.subscribers.of(view.streams.known("r2", CAMERA)) == ("aaaa2", "bbbb1")
    view.gone("aaaa1")
    assert {s.robot: s.generated for s in view.streams} == {"r2": 2, "r2-bbbb": 3}
    assert view.subscribers.of(view.streams.known("r2", CAMERA)) == ("bbbb1",)


def test_names_with_the_same_beginning_of_their_ids_differ(view):
    """As much of the id as it takes."""
    for zid in ("aaaa1111", "aaaa2222", "aaaa2333"):
        view.add_peer(0.0, "r2", zid)
    assert [peer.robot for peer in view.peers.values()] == ["r2", "r2-aaaa", "r2-aaaa2"]


def test_peers_are_bounded(view, monkeypatch):
    """Of a flood of tokens those that say nothing leave first; who speaks stays."""
    monkeypatch.setattr("proxy.core.view.view.TUNING", replace(TUNING, peers=3))
    meet(view)
    for number in range(10):
        assert view.add_peer(0.0, "x", f"x{number}")
    assert list(view.peers) == ["z-r2", "x8", "x9"]
    assert view.evicted == 8
    for zid in ("x8", "x9"):
        view.heard_state(0.0, State("x", zid, "", ""))
    assert not view.add_peer(0.0, "y", "y1")
    assert view.evicted == 9


def test_plain_nodes_that_fall_silent_are_forgotten(view):
    """After a minute, or a few periods."""
    view.overhearing.take(SampleHeard(1.0, CAMERA, 100, "feed", None, None))
    view.sweep(30.0)
    assert len(list(view.streams)) == 1
    view.sweep(35.0)
    view.sweep(62.0)
    assert list(view.streams) == []


def test_an_origin_claimed_later_moves_its_streams_to_the_robot(view):
    """What was overheard of them stays known; what the robot has already is not taken twice."""
    for now in (0.0, 0.5, 1.0, 1.5, 2.0):
        view.overhearing.take(SampleHeard(now, CAMERA, 100, "feed", None, None))
        view.overhearing.take(SampleHeard(now, CAMERA, 100, "other", None, None))
    meet(view, origins=("feed",))
    assert {stream.robot for stream in view.streams} == {"r2", "?other"}
    moved = view.streams.known("r2", CAMERA)
    assert (moved.generated, moved.sent.t_sent, moved.schedule.period) == (0, 2.0, pytest.approx(0.5))
    meet(view, origins=("feed", "other"))
    assert [stream.robot for stream in view.streams] == ["r2"]
    view.heard_digest(3.0, digest(3.0, StreamDigest(7, 1, 1, 3.0, 3.0, 10, 1.0)))
    assert moved.generated == 1


def test_an_origin_that_becomes_ours_is_no_plain_node(view):
    """Its samples enter our app side now."""
    view.overhearing.take(SampleHeard(1.0, CAMERA, 100, "feed", None, None))
    view.overhearing.take(SampleHeard(1.0, CAMERA, 100, "other", None, None))
    assert view.origins.claim("feed")
    assert [stream.robot for stream in view.streams] == ["?other"]


def test_nobody_takes_over_an_origin(view):
    """Whoever claims first has it; a robot's own id and ours are never another's."""
    meet(view, origins=("app-2",))
    view.add_peer(1.0, "r3", "z-r3")
    view.heard_state(1.0, State("r3", "z-r3", "", "", origins=("app-2", "z-r1", "z-r2", "app-3")))
    robots = [view.origins.robot_of(origin) for origin in ("app-2", "z-r1", "z-r2", "app-3")]
    assert robots == ["r2", "r1", "r2", "r3"]
    view.gone("z-r2")
    assert view.origins.robot_of("app-2") == "r3"


def test_matching_outlives_its_stream(view, make_specs):
    """Zenoh says it once: neither a swap of specs nor an eviction may lose it, nor may it come too early."""
    key = "robot/r1/camera"
    view.streams.match(key, matching=True)
    assert view.subscribers.count(view.streams.touch(0.0, "r1", key)) == 1
    view.streams.set_specs(make_specs(text='[[information_type]]\nname="x"\nkeys=["x"]\nutility={kind="video"}\n'))
    view.streams.set_specs(make_specs())
    assert view.subscribers.count(view.streams.touch(0.0, "r1", key)) == 1
    view.streams.match(key, matching=False)
    assert view.subscribers.count(view.streams.touch(0.0, "r1", key)) == 0


def test_an_update_changes_only_the_streams_it_names(view):
    """One of another state than ours is not taken in."""
    meet(view, number=4, subscriptions=("robot/**",))
    update = State("r2", "z-r2", "", "", (StreamState(9, "robot/r2b/camera", "camera", 0.25),), number=5, since=4)
    assert view.heard_state(1.0, update)
    peer = view.peers["z-r2"]
    assert (peer.number, peer.keys[7], peer.keys[9], peer.subscriptions) == (
        5,
        CAMERA,
        "robot/r2b/camera",
        ("robot/**",),
    )
    assert not view.heard_state(1.0, State("r2", "z-r2", "", "", (), number=9, since=8))
    crowd = tuple(StreamState(100 + n, f"k{n}", "camera", 0.5) for n in range(4096))
    assert not view.heard_state(1.0, State("r2", "z-r2", "", "", crowd, number=6, since=5))
    assert peer.number == 5


def test_news_without_a_key_is_bounded(view):
    """Numbers that no state explains."""
    view.add_peer(0.0, "r2", "z-r2")
    news = tuple(StreamDigest(n, 1, 0, 1.0, 0.0, 10, 1.0) for n in range(1030))
    view.heard_digest(1.0, digest(1.0, *news))
    assert (len(view.peers["z-r2"].pending), view.peers["z-r2"].evicted) == (1024, 6)


def test_what_came_before_a_key_was_known_was_not_lost(view):
    """News that waits for its key is older than the samples that came since: they are not taken for others'."""
    streams, specs = (StreamState(7, CAMERA, "camera", 0.1),), view.specs.generation
    view.subscribers.set_own((CAMERA,))
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_digest(1.0, digest(1.0, StreamDigest(7, 2, 2, 1.0, 1.0, 10, 1.0)))
    peer = view.peers["z-r2"]
    view.heard_state(0.0, State("r2", "z-r2", "enforce", specs, (), origins=("r2-zid",)))
    for count in range(38):
        view.overhearing.take(SampleHeard(1.0 + 0.1 * count, CAMERA, 10, "r2-zid", None, None))
    view.heard_state(5.0, State("r2", "z-r2", "enforce", specs, streams, (), origins=("r2-zid",), number=1))
    view.heard_digest(5.1, digest(5.1, StreamDigest(7, 40, 40, 5.0, 5.0, 10, 1.0)))
    for count in range(20):
        view.overhearing.take(SampleHeard(5.1 + 0.1 * count, CAMERA, 10, "r2-zid", None, None))
    view.heard_digest(7.2, digest(7.2, StreamDigest(7, 60, 60, 7.0, 7.0, 10, 1.0)))
    assert peer.counted_samples == (20, 0)


def test_who_was_not_reached_after_all_is_reached_by_the_next_sample(view):
    """Though the same robots want it."""
    stream = view.streams.touch(0.0, "r1", CAMERA)
    names = ("z-r2", "z-r3")
    stream.reach(names)
    stream.miss(("z-r2",))
    assert stream.reached == {"z-r3"}
    stream.reach(names)
    assert stream.reached == set(names)


def test_what_was_last_sent_is_not_what_was_generated_since(view):
    """News tells of the last sample generated: one that was generated after the last was sent is another one."""
    meet(view)
    view.heard_digest(2.0, digest(1.9, StreamDigest(7, 1, 1, 1.8, 1.85, 900, 7.0)))
    view.heard_digest(3.0, digest(2.9, StreamDigest(7, 2, 1, 2.8, 1.85, 400, 2.0)))
    view.heard_digest(4.0, digest(3.9, StreamDigest(7, 3, 2, 3.8, 2.85, 50, 1.0)))
    stream = view.streams.known("r2", CAMERA)
    assert (stream.last.size, stream.last.scale) == (50, 1.0)
    assert (stream.sent.size, stream.sent.scale) == (400, 2.0)
