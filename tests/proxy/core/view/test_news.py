"""What digests and states tell of the streams of another robot."""

import pytest

from proxy.core.interface.events import SampleHeard
from proxy.core.model.settings import CoreSettings, broadcast
from proxy.core.protocol.messages import State, StreamDigest, StreamState
from proxy.core.view.stream import Generated, Sent
from proxy.core.view.tuning import TUNING
from proxy.core.view.view import SharedView
from tests.proxy.core.view.met import CAMERA, digest, meet

PYTHON = """
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
utility = { kind = "python", function = "tests.utility_specs.worths:by_red" }
features.red = { kind = "color_fraction", color = "red" }
"""


def test_news_of_a_stream_is_read_on_our_clock(view):
    """The sender's times pass through its clock offset."""
    meet(view)
    assert view.heard_digest(100.0, digest(5.0, StreamDigest(7, 3, 1, 4.9, 4.5, 1000, 2.0)))
    (stream,) = view.streams
    assert stream.last == Generated(pytest.approx(99.9), 1000, 2.0)
    assert stream.sent == Sent(pytest.approx(99.5), pytest.approx(99.5), 1000, 2.0, told=True)
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
    assert view.traffic.sent_since(0.0) == [(1.1, (10, 1), "r2", True), (1.3, (30, 1), "r2", True)]
    view.subscribers.set_own(("**",))
    meet(view)
    assert sorted(view.traffic.sent_since(0.0)) == [(1.1, (10, 1), "r2", True), (1.3, (30, 1), "r2", True)]


def test_what_is_heard_from_the_air_counts_by_that(make_specs):
    """However late it is named."""
    view = SharedView(CoreSettings("r1", "z-r1", transport=broadcast("g")), make_specs())
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", (), transport=broadcast("g")))
    view.heard_digest(1.0, digest(1.0, StreamDigest(7, 1, 1, 1.0, 1.0, 10, 1.0)))
    assert view.traffic.sent_since(0.0) == []


def test_what_a_robot_did_not_send_stays_known(view):
    """Samples that are heard before news of them are no more than were generated."""
    view.subscribers.set_own((CAMERA,))
    meet(view, origins=("r2-zid",))
    view.heard_digest(1.0, digest(1.0, StreamDigest(7, 5, 2, 1.0, 0.9, 10, 1.0)))
    (stream,) = view.streams
    assert stream.unsent == 3
    for at in (1.1, 1.2, 1.3, 1.4):
        view.overhearing.take(SampleHeard(at, CAMERA, 10, "r2-zid", None, None))
    assert stream.forwarded > stream.generated
    assert stream.unsent == 3
    view.heard_digest(1.5, digest(1.5, StreamDigest(7, 10, 6, 1.5, 1.4, 10, 1.0)))
    assert stream.unsent == 4


def test_what_came_before_a_key_was_known_was_not_lost(view):
    """News that waits for its key is older than the samples that came since: they are not taken for others'."""
    streams, specs = (StreamState(7, CAMERA, "camera", 0.1),), view.specs.generation
    view.subscribers.set_own((CAMERA,))
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_digest(1.0, digest(1.0, StreamDigest(7, 2, 2, 1.0, 1.0, 10, 1.0)))
    peer = view.peers["z-r2"]
    view.heard_state(0.0, State("r2", "z-r2", "enforce", specs, (), origins=("r2-zid",)))
    for count in range(38):
        view.overhearing.take(SampleHeard(1.3 + 0.1 * count, CAMERA, 10, "r2-zid", None, None))
    view.heard_state(5.0, State("r2", "z-r2", "enforce", specs, streams, (), origins=("r2-zid",), number=1))
    view.heard_digest(5.1, digest(5.1, StreamDigest(7, 40, 40, 5.0, 5.0, 10, 1.0)))
    for count in range(20):
        view.overhearing.take(SampleHeard(5.1 + 0.1 * count, CAMERA, 10, "r2-zid", None, None))
    view.heard_digest(7.2, digest(7.2, StreamDigest(7, 60, 60, 7.0, 7.0, 10, 1.0)))
    assert (peer.inbound.losses.counted, peer.outbound.losses.counted) == ((20, 0), (0, 0))


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


def test_what_was_last_sent_is_not_what_was_generated_since(view):
    """News tells of the last sample generated: one that was generated after the last was sent is another one."""
    meet(view)
    view.heard_digest(2.0, digest(1.9, StreamDigest(7, 1, 1, 1.8, 1.85, 900, 7.0)))
    view.heard_digest(3.0, digest(2.9, StreamDigest(7, 2, 1, 2.8, 1.85, 400, 2.0)))
    view.heard_digest(4.0, digest(3.9, StreamDigest(7, 3, 2, 3.8, 2.85, 50, 1.0)))
    stream = view.streams.known("r2", CAMERA)
    assert (stream.last.size, stream.last.scale) == (50, 1.0)
    assert (stream.sent.size, stream.sent.scale) == (400, 2.0)


def test_a_stream_that_its_robot_met_again_counts_from_the_start(view):
    """It has another number then; what is said of the one before does not bring that back."""

    def announce(at, state, stream):
        streams = (StreamState(stream, CAMERA, "camera", 0.5),)
        view.heard_state(at, State("r2", "z-r2", "enforce", "", streams, number=state))

    view.add_peer(0.0, "r2", "z-r2")
    announce(0.0, 1, stream=7)
    view.heard_digest(1.0, digest(1.0, StreamDigest(7, 300, 300, 1.0, 1.0, 10, 1.0)))
    view.heard_digest(2.0, digest(2.0, StreamDigest(9, 1, 1, 2.0, 2.0, 20, 1.0)))
    announce(2.1, 2, stream=9)
    view.heard_digest(3.0, digest(3.0, StreamDigest(9, 2, 2, 3.0, 3.0, 30, 1.0)))
    view.heard_digest(3.1, digest(3.1, StreamDigest(7, 301, 301, 3.0, 3.0, 40, 1.0)))
    announce(3.2, 3, stream=9)
    stream = view.streams.known("r2", CAMERA)
    assert (stream.id, stream.generated, stream.forwarded, stream.last.size) == (9, 2, 2, 30)
    assert [size for _, (size, _), *_ in view.traffic.sends] == [10, 20, 30, 40]


def test_of_a_stream_that_its_robot_met_again_nothing_is_known_until_it_tells(view):
    """Its state names another number. One that was only overheard has had none, and stays."""
    meet(view)
    view.heard_digest(1.0, digest(1.0, StreamDigest(7, 3, 3, 1.0, 1.0, 10, 1.0)))
    state = State("r2", "z-r2", "enforce", "", (StreamState(9, CAMERA, "camera", 0.5),), origins=("r2-zid",))
    view.heard_state(2.0, state)
    assert view.streams.known("r2", CAMERA) is None
    view.overhearing.take(SampleHeard(2.5, CAMERA, 10, "r2-zid", None, None))
    overheard = view.streams.known("r2", CAMERA)
    view.heard_state(3.0, state)
    assert view.streams.known("r2", CAMERA) is overheard


@pytest.mark.parametrize("forged", [(1_190_000, 1_190_000), (400, 400)], ids=["generated", "sent"])
def test_counts_that_were_forged_do_not_last(view, forged):
    """What its robot tells of a stream counts less then: in time that holds."""
    meet(view)
    view.heard_digest(1.0, digest(1.0, StreamDigest(7, 400, 3, 1.0, 1.0, 10, 1.0)))
    view.heard_digest(1.5, digest(1.5, StreamDigest(7, *forged, 1.5, 1.5, 10, 1.0)))
    counts = []
    for k in range(round(TUNING.implausible_for) + 2):
        at = 2.0 + k
        view.heard_digest(at, digest(at, StreamDigest(7, 401 + k, 4 + k, at, at, 10, 1.0)))
        stream = view.streams.known("r2", CAMERA)
        counts.append((stream.generated - 401 - k, stream.forwarded - 4 - k))
    assert (0, 0) not in counts[:5]
    assert counts[-1] == (0, 0)


def test_what_was_overheard_twice_makes_no_stream_anew(view):
    """Its robot tells of fewer samples than were heard: it knows better, by and by."""
    meet(view, origins=("r2-zid",))
    view.heard_digest(1.0, digest(1.0, StreamDigest(7, 1, 1, 1.0, 1.0, 10, 1.0)))
    stream = view.streams.known("r2", CAMERA)
    for k in range(3):
        view.overhearing.take(SampleHeard(1.5 + 0.1 * k, CAMERA, 10, "r2-zid", None, None))
    for k in range(20):
        view.heard_digest(2.0 + k, digest(2.0 + k, StreamDigest(7, 2 + k, 2, 2.0 + k, 1.9, 10, 1.0)))
    assert view.streams.known("r2", CAMERA) is stream
    assert stream.generated == 21


def test_of_a_robot_that_passed_samples_all_else_counts_at_once(view):
    """We heard those, and it does not count them: how many it sent holds by and by, and what it sends then counts."""
    meet(view, origins=("r2-zid",))
    view.heard_digest(1.0, digest(1.0, StreamDigest(7, 1, 1, 1.0, 1.0, 10, 1.0)))
    for k in range(80):
        view.overhearing.take(SampleHeard(1.5 + 0.1 * k, CAMERA, 10, "r2-zid", None, None))
    stream = view.streams.known("r2", CAMERA)
    ahead = []
    for k in range(2, round(TUNING.implausible_for) + 4):
        at = 10.0 + k
        view.heard_digest(at, digest(at, StreamDigest(7, k, k, at, at, 10, float(k))))
        assert (stream.generated, stream.last.scale) == (k, float(k))
        ahead.append(stream.forwarded - k)
    assert min(ahead[: round(TUNING.implausible_for)]) > 0
    assert ahead[-2:] == [0, 0]
    assert stream.sent.t_sent == pytest.approx(at)


def test_samples_that_come_before_their_digest_count_once(view):
    """However often: each digest that tells of as many as came agrees with us."""
    meet(view, origins=("r2-zid",))
    view.heard_digest(1.0, digest(1.0, StreamDigest(7, 1, 1, 1.0, 1.0, 10, 1.0)))
    for k in range(2, 40):
        view.overhearing.take(SampleHeard(float(k), CAMERA, 10, "r2-zid", None, None))
        view.heard_digest(k + 0.1, digest(k + 0.1, StreamDigest(7, k, k - 1, float(k), k - 1.0, 10, 1.0)))
        view.heard_digest(k + 0.2, digest(k + 0.2, StreamDigest(7, k, k, float(k), float(k), 10, 1.0)))
    assert view.streams.known("r2", CAMERA).forwarded == 39
    assert len(view.traffic.sends) == 39
