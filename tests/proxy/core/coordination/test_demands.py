"""What a robot asks for of a limit, by its streams."""

import pytest

from proxy.core.coordination.demands import bid, usual
from proxy.core.coordination.tuning import TUNING
from proxy.core.model.lifetimes import worthless_from
from proxy.core.model.limits import limits_of
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.bid import QUARTERS, UNIT
from proxy.core.transit.latency import Latency
from proxy.core.view.stream import Generated
from proxy.core.view.view import SharedView


@pytest.fixture
def make_view(make_specs):
    """A robot of a team of two with one stream of 10 Hz."""

    def make(size, value=1.0, *, wanted=True, samples=50, specs=None):
        view = SharedView(CoreSettings("r1", "z1"), specs or make_specs(window=0.5))
        view.add_peer(0.0, "r2", "z2")
        stream = view.streams.touch(0.0, "r1", "robot/r1/camera")
        stream.matching = wanted
        for count in range(samples):
            stream.note_generated(count + 1, Generated(5.0 - 0.1 * (samples - count), size, value))
        return view

    return make


def asked(view):
    return bid(view, 5.0, limits_of(view.specs, 0.02, 2))


def test_a_usual_message_is_what_large_ones_take_in_the_mean(make_view):
    """None where all are small."""
    view = make_view(2_000)
    limits = limits_of(view.specs, 0.02, 2)
    assert usual(view, 5.0, limits) == pytest.approx(UNIT * 2_000 / limits[0].limit, rel=0.01)
    assert usual(make_view(10), 5.0, limits) == 0


def test_small_messages_ask_for_room_for_all_of_them(make_view):
    """What they use in a window in the mean, before what is spare."""
    view = make_view(10)
    (limit,) = limits_of(view.specs, 0.02, 2)
    *first, _ = asked(view)
    assert not any(segment.quarters for segment in first)
    assert sum(segment.amount for segment in first) == pytest.approx(UNIT * 5 * 10 / limit.limit, abs=len(first))


def test_a_large_message_asks_for_a_slot(make_view):
    """The first one of several windows is worth most."""
    first = asked(make_view(2_000))[0]
    assert first.quarters


def test_what_is_worth_more_asks_at_a_higher_level(make_view):
    """So that the value decides who gets the room."""
    assert asked(make_view(2_000, 8.0))[0].level > asked(make_view(2_000, 1.0))[0].level


def test_what_nobody_wants_asks_for_nothing(make_view):
    """Nor does a stream that is over."""
    assert asked(make_view(2_000, wanted=False)) == ()
    view = make_view(2_000)
    assert bid(view, 500.0, limits_of(view.specs, 0.02, 2)) == ()


def test_a_new_stream_asks_for_a_few_messages(make_view):
    """Of one sample nobody knows how soon the next one comes: it is not taken to come at once."""
    view = make_view(10, samples=1)
    (limit,) = limits_of(view.specs, 0.02, 2)
    assert sum(segment.amount for segment in asked(view)) <= UNIT * 12 * 10 / limit.limit


def test_of_a_new_stream_of_which_each_sample_counts_no_more_is_asked_for_than_came(make_view, make_specs):
    """After one alarm a robot asked for three a window, and kept that room from one that had none for its own."""
    alarms = make_specs(text=FADING.replace("2.5", "0.5") + 'aggregation = "sum"\n')
    others = make_specs(text=FADING.replace("2.5", "0.5"))
    asked_for = [asked(make_view(1_500, samples=1, specs=specs)) for specs in (alarms, others)]
    assert sum(segment.quarters for segment in asked_for[0]) == QUARTERS
    assert sum(segment.quarters for segment in asked_for[1]) > QUARTERS


def test_how_long_messages_take_changes_no_bid(make_view):
    """Each robot learns it at another moment, and all would ask for something else then."""
    soon, late = make_view(2_000), make_view(2_000)
    (peer,) = late.peers.values()
    peer.outbound.latency = Latency(1.0)
    stream = late.streams.known("r1", "robot/r1/camera")
    assert late.audiences.of(5.0, stream).mean == 1.0
    assert asked(late) == asked(soon)


def test_what_comes_too_late_asks_for_nothing(make_view):
    """It is worth nothing any more long before it is received."""
    late = make_view(2_000)
    (peer,) = late.peers.values()
    end = worthless_from(late.streams.known("r1", "robot/r1/camera").information_type.utility)
    peer.outbound.latency = Latency(TUNING.too_late * end)
    assert asked(late) == ()


FADING = """
[[constraint]]
kind = "throughput"
limit = "10 kB/s"
window = 2.5

[[information_type]]
name = "camera"
keys = ["*/*/camera"]
utility = { kind = "linear", slope = 0.7 }
"""


def test_messages_of_a_rhythm_lie_whole_periods_apart(make_specs):
    """Two of three samples of 1 Hz are not 1.5 s apart, but one and two: the second in a window is worth less."""
    view = SharedView(CoreSettings("r1", "z1"), make_specs(text=FADING))
    view.add_peer(0.0, "r2", "z2")
    stream = view.streams.touch(0.0, "r1", "robot/r1/camera")
    stream.matching = True
    for count in range(20):
        stream.note_generated(count + 1, Generated(count - 20.0, 4_000, 1.0))
    levels = [segment.level for segment in bid(view, 0.0, limits_of(view.specs, 0.02, 2))]
    assert levels[0] > levels[-1]
    assert levels.count(levels[0]) == 3  # the quarters of one slot
