"""What samples tell that are overheard."""

import pytest

from proxy.core.interface.events import SampleHeard
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import Digest, State, StreamDigest, StreamState
from proxy.core.view.view import SharedView
from tests.proxy.core.view.met import CAMERA, digest, meet


@pytest.mark.parametrize(("origin", "robot"), [("feed", "?feed"), (None, "?")])
def test_a_plain_node_is_estimated_from_what_is_heard(view, origin, robot):
    """Its id is no robot's, or it does not stamp, so every sample of it counts as generated and sent."""
    for now in (1.0, 1.5, 2.0):
        view.overhearing.take(SampleHeard(now, "robot/plain/camera", 100, origin, None, None))
    view.overhearing.take(SampleHeard(2.0, "no/spec", 100, origin, None, None))
    (stream,) = view.streams
    assert (stream.robot, stream.generated, stream.forwarded) == (robot, 3, 3)
    assert sum(size for _, (size, _), *_ in view.traffic.sends) == 300
    assert stream.schedule.period == pytest.approx(0.5)


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


@pytest.mark.parametrize(("late", "sends"), [(0.02, 1), (0.2, 1), (0.9, 2)])
def test_a_sample_that_its_digest_overtook_counts_once_however_late_it_comes(make_specs, late, sends):
    """The next one of its stream, about a period later, counts: then the first one was lost."""
    view = SharedView(CoreSettings("r1", "z-r1", transport="udp/224.0.0.226:7449"), make_specs())
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", (StreamState(1, CAMERA, "camera", 1.0),)))
    name = next(iter(view.peers))
    for now in (1.0, 2.0, 3.0, 4.0, 5.0):
        number = int(now)
        told = StreamDigest(1, number, number, now - 0.01, now - 0.01, 100, 1.0)
        view.heard_digest(now, Digest("r2", name, now - 0.01, 0, 0, (told,)))
        view.overhearing.take(SampleHeard(now + (late if number == 5 else 0.0), CAMERA, 100, "z-r2", None, None))
    assert view.streams.known("r2", CAMERA).forwarded == 4 + sends
    assert len(view.traffic.sent_since(4.5)) == sends


def test_a_sample_counts_at_once_though_others_of_its_stream_waited_longer_before_they_were_sent(make_specs):
    """By what samples usually wait it would have been generated before the one that was sent last."""
    view = SharedView(CoreSettings("r1", "z-r1", transport="udp/224.0.0.226:7449"), make_specs())
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", (StreamState(1, CAMERA, "camera", 0.25),)))
    name = next(iter(view.peers))
    for number in range(1, 6):
        sent = 0.25 * number + 0.2
        told = StreamDigest(1, number, number, sent - 0.2, sent, 100, 1.0)
        view.heard_digest(sent, Digest("r2", name, sent, 0, 0, (told,)))
        view.overhearing.take(SampleHeard(sent + 0.001, CAMERA, 100, "z-r2", None, None))
    view.peers[name].offset.echoed(1.4, 1.4)
    view.overhearing.take(SampleHeard(1.5, CAMERA, 110, "z-r2", None, None))
    assert view.streams.known("r2", CAMERA).forwarded == 6
    assert len(view.traffic.sent_since(1.44)) == 2


@pytest.mark.parametrize(("size", "sends"), [(30_000, 1), (29_000, 2)])
def test_a_sample_of_a_fast_stream_may_be_later_than_the_next_one_if_it_has_the_size_that_was_told(
    make_specs, size, sends
):
    """It waits on the air behind others; one that comes after it counts in any case."""
    view = SharedView(CoreSettings("r1", "z-r1", transport="udp/224.0.0.226:7449"), make_specs())
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", (StreamState(1, CAMERA, "camera", 0.1),)))
    name = next(iter(view.peers))
    for number in range(1, 11):
        now = 0.1 * number
        told = StreamDigest(1, number, number, now - 0.001, now - 0.001, 30_000, 1.0)
        view.heard_digest(now, Digest("r2", name, now - 0.001, 0, 0, (told,)))
        if number < 10:
            view.overhearing.take(SampleHeard(now, CAMERA, 30_000, "z-r2", None, None))
    view.overhearing.take(SampleHeard(1.06, CAMERA, size, "z-r2", None, None))
    assert view.streams.known("r2", CAMERA).forwarded == 9 + sends
    view.overhearing.take(SampleHeard(1.09, CAMERA, 30_000, "z-r2", None, None))
    assert view.streams.known("r2", CAMERA).forwarded == 10 + sends


def test_samples_that_their_digests_overtook_count_once_though_the_next_one_is_told_of_before_they_come(make_specs):
    """On a channel where samples wait behind others, and digests go by."""
    view = SharedView(CoreSettings("r1", "z-r1", transport="udp/224.0.0.226:7449"), make_specs())
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", (StreamState(1, CAMERA, "camera", 0.1),)))
    name, waits = next(iter(view.peers)), 0.25
    view.peers[name].offset.echoed(0.0, 0.0)
    view.peers[name].inbound.set_wall_offset(0.0, 0.0)
    events = []
    for number in range(1, 31):
        sent = 0.1 * number
        told = StreamDigest(1, number, number, sent, sent, 30_000, 1.0)
        events.append((sent + 0.001, Digest("r2", name, sent, 0, 0, (told,))))
        events.append((sent + waits, SampleHeard(sent + waits, CAMERA, 30_000, "z-r2", sent, None)))
    for now, event in sorted(events, key=lambda each: each[0]):
        if isinstance(event, Digest):
            view.heard_digest(now, event)
        else:
            view.overhearing.take(event)
        assert view.streams.known("r2", CAMERA).forwarded <= int((now + 1e-6) / 0.1)
    assert view.streams.known("r2", CAMERA).forwarded == 30


@pytest.mark.parametrize(
    ("came", "generated", "sends"), [(2.15, 2.0, 1), (2.15, 1.8, 1), (2.15, 2.003, 2), (2.02, 2.003, 1)]
)
def test_a_sample_is_the_one_that_was_told_if_its_timestamp_says_so(make_specs, came, generated, sends):
    """However much longer than usual it takes: the news that follow tell of the next one, which nobody may hide.

    A clock that runs ahead says nothing: then what samples take does.
    """
    view = SharedView(CoreSettings("r1", "z-r1", transport="udp/224.0.0.226:7449"), make_specs())
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", (StreamState(1, CAMERA, "camera", 0.2),)))
    name, shown = next(iter(view.peers)), 1000.0
    view.peers[name].offset.echoed(0.0, 0.0)
    view.peers[name].inbound.set_wall_offset(0.0, shown)
    for number in range(1, 11):
        sent = 0.2 * number
        told = StreamDigest(1, number, number, sent, sent, 30_000, 1.0)
        view.heard_digest(sent + 0.001, Digest("r2", name, sent, 0, 0, (told,)))
        if number < 10:
            view.overhearing.take(SampleHeard(sent + 0.02, CAMERA, 30_000, "z-r2", shown + sent, None))
    stream = view.streams.known("r2", CAMERA)
    assert (stream.forwarded, stream.sent.told) == (10, True)
    view.overhearing.take(SampleHeard(came, CAMERA, 29_000, "z-r2", shown + generated, None))
    assert stream.forwarded == 9 + sends
    told = StreamDigest(1, 11, 9 + sends + 1, 2.2, 2.2, 30_000, 1.0)
    view.heard_digest(2.201, Digest("r2", name, 2.2, 0, 0, (told,)))
    assert view.traffic.sends[-1][0] == pytest.approx(2.2, abs=0.001)


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


def test_what_comes_late_of_a_robot_that_left_is_no_plain_node(view):
    """It took its part of the channel all the same; what comes for longer is another node's, or it did not leave."""
    meet(view, origins=("app-2",))
    view.gone(3.0, "z-r2")
    for origin in ("app-2", "z-r2"):
        view.overhearing.take(SampleHeard(4.0, CAMERA, 100, origin, None, None))
    assert not list(view.streams)
    assert len(view.traffic.sent_since(4.0)) == 2
    view.overhearing.take(SampleHeard(5.1, CAMERA, 100, "app-2", None, None))
    assert [stream.robot for stream in view.streams] == ["?app-2"]
    meet(view, origins=("app-2",))
    assert [stream.robot for stream in view.streams] == ["r2"]


def test_nobody_takes_over_an_origin(view):
    """Whoever claims first has it; a robot's own id and ours are never another's."""
    meet(view, origins=("app-2",))
    view.add_peer(1.0, "r3", "z-r3")
    view.heard_state(1.0, State("r3", "z-r3", "", "", origins=("app-2", "z-r1", "z-r2", "app-3")))
    robots = [view.origins.robot_of(origin) for origin in ("app-2", "z-r1", "z-r2", "app-3")]
    assert robots == ["r2", "r1", "r2", "r3"]
    view.gone(1.0, "z-r2")
    assert view.origins.robot_of("app-2") == "r3"
