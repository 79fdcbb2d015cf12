"""Those that gain by a stream, and when they are looked at anew."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner import Receiver
from proxy.core.model.settings import CoreSettings
from proxy.core.transit.latency import Latency
from proxy.core.view.audience import Way, grouped
from proxy.core.view.stream import Generated
from proxy.core.view.tuning import TUNING
from proxy.core.view.view import SharedView
from tests.proxy.core.view.met import join, lose, team


@pytest.fixture
def view(make_specs):
    """Robots r2, r3 and r4 want all cameras, as we do."""
    return team(make_specs())


def test_an_audience_is_looked_at_anew_when_somebody_joins_or_after_a_while(view):
    """Not for every decision: with many robots that takes long."""
    own = view.streams.touch(0.0, "r1", "robot/r1/camera")
    own.note_generated(1, Generated(0.0, 1024, 1.0))
    for peer in view.peers.values():
        peer.outbound.latency = Latency(0.1, 1e-5)
    audience = view.audiences.of(1.0, own)
    assert (audience.latency_of(1000), audience.latency_of(2000)) == pytest.approx((0.11, 0.12))
    view.peers["z-r2"].outbound.latency = Latency(0.4)
    assert view.audiences.of(1.1, own) is audience
    later = view.audiences.of(1.0 + TUNING.ways_refresh, own)
    assert (later.mean, later.slowest, later.share) == pytest.approx(((0.4 + 2 * 0.11024) / 3, 0.4, 3.0))
    view.gone(1.0, "z-r2")
    assert view.audiences.of(1.0 + TUNING.ways_refresh, own).share == 2.0
    for robot in ("r3", "r4"):
        view.gone(1.0, f"z-{robot}")
    assert view.audiences.of(1.0 + TUNING.ways_refresh, own).share == 1.0


def test_where_all_ways_are_taken_alike_only_the_mean_loss_counts(view):
    """What is known of a way by its own samples counts again where they are not."""
    own, other = (view.streams.touch(0.0, robot, f"robot/{robot}/camera") for robot in ("r1", "r2"))
    for stream in (own, other):
        stream.note_generated(1, Generated(0.0, 1000, 1.0))
    for name, sent, came in (("z-r2", 100, 100), ("z-r3", 20, 10), ("z-r4", 50, 45)):
        lose(view.peers[name], sent, came)
    known, mean = view.audiences.of(1.0, own).share, view.audiences.of(1.0, other).share
    assert known != pytest.approx(mean)
    view.audiences.take_alike(alike=True)
    each = [view.audiences.of(1.0, stream).share for stream in (own, other)]
    assert each == pytest.approx([3.0 * (1.0 - view.paths.mean_loss())] * 2)
    view.audiences.take_alike(alike=False)
    assert view.audiences.of(1.0, own).share == known


def test_in_a_large_team_audiences_are_looked_at_anew_more_rarely(view):
    """There each is more work, and there are more of them."""
    for number in range(2 * TUNING.small_team - 3):
        join(view, f"x{number}")
    own = view.streams.touch(0.0, "r1", "robot/r1/camera")
    own.note_generated(1, Generated(0.0, 1000, 1.0))
    audience = view.audiences.of(1.0, own)
    view.peers["z-r2"].outbound.latency = Latency(0.4)
    assert view.audiences.of(1.0 + 1.9 * TUNING.ways_refresh, own) is audience
    assert view.audiences.of(1.0 + 2.1 * TUNING.ways_refresh, own).slowest == pytest.approx(0.4)


def test_streams_of_one_robot_have_one_audience_while_it_is_the_same(view):
    """Samples of another size have their own, and when it is time they are looked at together."""
    streams = [view.streams.touch(0.0, "r1", f"robot/{number}/camera") for number in range(3)]
    for stream, size in zip(streams, (1000, 1000, 2000), strict=True):
        stream.note_generated(1, Generated(0.0, size, 1.0))
    first, second, larger = (view.audiences.of(1.0, stream) for stream in streams)
    assert second is first
    assert larger is not first
    later = 1.0 + TUNING.ways_refresh
    assert view.audiences.of(later, streams[1]) is view.audiences.of(later, streams[0])


def test_audiences_are_bounded(make_specs):
    """Those of streams that there are no more are forgotten, and of sizes that were."""
    view = SharedView(CoreSettings("r1", "z-r1", streams=3), make_specs())
    for number in range(20):
        stream = view.streams.touch(float(number), "r1", f"robot/{number}/camera")
        stream.note_generated(1, Generated(0.0, number, 1.0))
        view.audiences.of(float(number), stream)
    assert len(view.audiences._known) <= 4
    assert len(view.audiences._common) <= 4


def test_equal_latencies_are_one_group():
    """To the millisecond; who hears first has no delay."""
    assert grouped([Way(0.02)]) == (0.02, (Receiver(0.0, 1.0),))
    latency, receivers = grouped([Way(0.0201), Way(0.1), Way(0.0199)])
    assert latency == pytest.approx(0.02)
    assert receivers == (Receiver(0.0, 2.0), Receiver(pytest.approx(0.08), 1.0))


def test_a_robot_counts_as_far_as_messages_get_to_it():
    """So does its latency within its group; where nothing gets, all count alike."""
    latency, receivers = grouped([Way(0.02, 0.75), Way(0.0204, 0.25)])
    assert latency == pytest.approx(0.0201)
    assert receivers == (Receiver(0.0, 1.0),)
    assert grouped([Way(0.01, 0.0), Way(0.0102, 0.0)]) == (pytest.approx(0.0101), (Receiver(0.0, 0.0),))


def test_too_many_groups_are_joined_where_they_are_closest():
    """At the mean of their robots."""
    latency, receivers = grouped(map(Way, [0.01, 0.02, 0.022, 0.0222, 0.1, 0.2]))
    assert latency == 0.01
    assert [r.share for r in receivers] == [1.0, 3.0, 1.0, 1.0]
    assert [r.delay for r in receivers] == pytest.approx([0.0, 0.0114, 0.09, 0.19])


@given(st.lists(st.tuples(st.floats(0.0, 5.0), st.floats(0.05, 1.0)), min_size=1, max_size=30))
def test_every_robot_counts_once_and_the_mean_latency_stays(drawn):
    """However they are grouped."""
    latency, receivers = grouped(Way(*way) for way in drawn)
    assert 1 <= len(receivers) <= TUNING.receiver_groups
    assert min(r.delay for r in receivers) == 0.0
    share = sum(share for _, share in drawn)
    assert sum(r.share for r in receivers) == pytest.approx(share)
    mean = latency + sum(r.delay * r.share for r in receivers) / share
    assert mean == pytest.approx(sum(took * part for took, part in drawn) / share)
