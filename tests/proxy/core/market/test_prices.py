"""How streams stand at the price of what they compete for."""

from dataclasses import replace

import pytest

from planner import Aggregation, Receiver, Throughput
from proxy.core.market.prices import Market
from proxy.core.market.standing import Row, Standing, count_new, interval_of, reserve, row_of
from proxy.core.market.tuning import TUNING
from proxy.core.model.limits import Limit
from proxy.core.view.audience import Audience
from proxy.core.view.stream import Generated, Sent, Stream

HORIZON = 120
LIMIT = Limit("throughput", 0.5, 62_500.0, Throughput(62_500.0, 0.5))
TYPES = """
[[information_type]]
name = "camera"
keys = ["camera"]
utility = { kind = "video" }
[[information_type]]
name = "odometry"
keys = ["odometry"]
utility = { kind = "linear", slope = 1.0 }
[[information_type]]
name = "alarm"
keys = ["alarm"]
aggregation = "sum"
weight = 20
utility = { kind = "step", lifetime = "10 s" }
[[information_type]]
name = "chatter"
keys = ["chatter"]
weight = 0.0001
utility = { kind = "linear", slope = 1.0 }
[[information_type]]
name = "status"
keys = ["status"]
utility = { kind = "step", lifetime = "20 s" }
[[information_type]]
name = "fresh"
keys = ["fresh"]
utility = { kind = "step", lifetime = "350 ms" }
[[information_type]]
name = "finding"
keys = ["finding"]
aggregation = "current"
weight = 0.0001
utility = { kind = "linear", slope = 1.0 }
[[information_type]]
name = "vital"
keys = ["vital"]
weight = 0.0001
min_rate = "1 Hz"
utility = { kind = "linear", slope = 1.0 }
"""


@pytest.fixture
def make_row(make_specs):
    """A stream of a key as it is weighed."""
    specs = make_specs(text=TYPES)

    def make(key, rate, size, *, generated=20, deviation=0.0, scale=None, shown=None):
        kind = specs.match(key)
        stream = Stream(1, "r1", key, kind)
        for count in range(generated):
            stream.note_generated(count + 1, Generated(count / rate, size, kind.scale({}) if scale is None else scale))
        if shown is not None:
            stream.note_sent(1, Sent(0.0, 0.0, size, shown))
        relief = 1.0 if kind.aggregation is Aggregation.CURRENT else 0.0
        return Row(stream, 1.0 / rate, 0.0, stream.newest.scale, (float(size),), (deviation,), relief)

    return make


def weighed(*rows):
    market, steady = Market.of(rows, (LIMIT,), HORIZON)
    return market.weigh(rows, steady)


def standings(*rows):
    return [each.standing for each in weighed(*rows)]


def test_small_samples_that_earn_their_price_are_undisputed_and_frames_contested(make_row):
    """Two frames fit in a window: which ones the tree decides; odometry and alarms earn many times their price."""
    rows = make_row("camera", 10.0, 26_000), make_row("odometry", 20.0, 116), make_row("alarm", 0.125, 76)
    assert standings(*rows) == [Standing.CONTESTED, Standing.UNDISPUTED, Standing.UNDISPUTED]


def test_where_all_fits_nothing_is_contested(make_row):
    """Not even frames."""
    rows = make_row("camera", 2.0, 8_000), make_row("odometry", 20.0, 116)
    assert standings(*rows) == [Standing.UNDISPUTED] * 2


def test_small_samples_are_sent_as_often_as_pays(make_row):
    """A crowd of equal streams shares the limit by intervals."""
    rows = [make_row("odometry", 20.0, 1_000) for _ in range(20)]
    crowd = weighed(*rows)
    assert {each.standing for each in crowd} == {Standing.PRICED}
    used = sum(1_000 / each.apart for each in crowd)
    assert 0.6 * 125_000 <= used <= 1.3 * 125_000


@pytest.mark.parametrize(("size", "often"), [(40_000, True), (26_500, False), (61_000, False), (90_000, False)])
def test_small_samples_take_what_whole_frames_leave(make_row, size, often):
    """However many of these are left out; but no frame gives way, nor what is larger than a window or nearly so."""
    rows = *(make_row("camera", 10.0, size) for _ in range(3)), *(make_row("odometry", 50.0, 250) for _ in range(3))
    small = weighed(*rows)[3:]
    assert {each.standing for each in small} == {Standing.PRICED}
    assert {each.apart == 0.02 for each in small} == {often}


@pytest.mark.parametrize(("size", "generated", "apart"), [(1_000, 20, 2), (2_000, 20, 4), (400, 20, 1), (1_000, 2, 1)])
def test_samples_that_are_not_needed_leave_the_others_room(make_row, size, generated, apart):
    """Where one in many would do, nothing has a price, and not all fits; of how often it comes enough is known."""
    status = [make_row("status", 50.0, size, generated=generated) for _ in range(4)]
    *found, pose = weighed(*status, make_row("odometry", 10.0, 400))
    assert pose.standing is Standing.UNDISPUTED
    assert [each.apart / each.interval for each in found] == pytest.approx([apart] * 4)
    assert (found[0].standing is Standing.PRICED) is (apart > 1)


def test_no_sample_that_is_needed_is_left_out(make_row):
    """Status that does for three intervals goes at least every third time, however little others leave."""
    status = [make_row("fresh", 10.0, 4_000) for _ in range(4)]
    found = weighed(*status, *(make_row("odometry", 10.0, 1_000) for _ in range(10)))[:4]
    assert {round(each.apart / each.interval) for each in found} <= {1, 2, 3}


def test_a_limit_of_our_own_leaves_the_streams_of_others_as_they_are(make_row):
    """They use nothing of it, and do not know it."""
    limits = LIMIT, replace(LIMIT, name="energy", limit=5_000.0)
    ours = [make_row("status", 50.0, 100)._replace(use=(100.0, 100.0), deviation=(0.0, 0.0))] * 3
    theirs = [make_row("status", 50.0, 100)._replace(use=(100.0, 0.0), deviation=(0.0, 0.0))]
    rows = [*ours, *theirs]
    market, steady = Market.of(rows, limits, HORIZON)
    own, *_, other = market.weigh(rows, steady)
    assert own.apart > own.interval
    assert other.standing is Standing.UNDISPUTED


def test_small_samples_take_no_more_than_may_be_booked(make_row):
    """Beside frames as large as the limit."""
    rows = make_row("camera", 10.0, 62_000), *(make_row("odometry", 50.0, 1_000) for _ in range(4))
    used = sum(1_000 / each.apart for each in weighed(*rows) if each.standing is Standing.PRICED)
    assert used <= TUNING.booked * 125_000


def test_small_samples_that_fill_a_limit_leave_nothing_to_take(make_row):
    """They went at any price beside one camera, and wanted five times the limit."""
    rows = make_row("camera", 5.0, 12_000), *(make_row("odometry", 100.0, 119) for _ in range(60))
    camera, *small = weighed(*rows)
    assert camera.standing is Standing.CONTESTED
    assert {each.standing for each in small} == {Standing.PRICED}
    assert sum(119 / each.apart for each in small) <= 125_000


def test_what_earns_a_small_part_of_the_price_is_hopeless_unless_it_is_guaranteed(make_row):
    """However seldom it is sent."""
    cameras = [make_row("camera", 10.0, 26_000) for _ in range(4)]
    rows = make_row("chatter", 5.0, 20_000), make_row("vital", 5.0, 20_000), *cameras
    assert standings(*rows)[:3] == [Standing.HOPELESS, Standing.CONTESTED, Standing.CONTESTED]


def test_new_streams_are_contested_unless_they_earn_many_times_their_price(make_row):
    """An alarm never heard before goes at once; what else is new has to show its rate."""
    cameras = [make_row("camera", 10.0, 26_000) for _ in range(4)]
    rows = make_row("alarm", 2.0, 76, generated=1), make_row("chatter", 2.0, 76, generated=1), *cameras
    assert standings(*rows)[:2] == [Standing.UNDISPUTED, Standing.CONTESTED]
    few = make_row("camera", 2.0, 8_000, generated=TUNING.rate_samples - 1)
    assert standings(few) == [Standing.CONTESTED]


def test_the_reserve_holds_what_streams_use_in_nearly_any_window(make_row):
    """Ten samples of 116 B, now and then eleven; what comes at random needs more room than what is periodic."""
    (periodic,) = reserve([make_row("odometry", 20.0, 116)], [0.05], (LIMIT,))
    assert 11 * 116 <= periodic <= 12 * 116
    varying = make_row("odometry", 20.0, 116, deviation=50.0)
    assert reserve([varying], [0.05], (LIMIT,))[0] > periodic


def test_a_new_stream_generates_no_more_than_as_many_again(make_row):
    """A burst ends; a stream that is known goes on as it does."""
    assert interval_of(0.1, make_row("odometry", 100.0, 116, generated=2).stream, 0.5) == pytest.approx(0.125)
    assert interval_of(9.0, make_row("odometry", 20.0, 116).stream, 0.5) == pytest.approx(0.05)
    seldom = make_row("odometry", 100.0, 116, generated=2).stream  # twice in so long
    assert interval_of(seldom.began + 8.0, seldom, 0.5) == pytest.approx(8.0 / 4)


def test_of_many_new_streams_not_all_generate_more_than_expected(make_row):
    """Of 2,000 that said one thing a second ago nobody expects thousands of samples a second."""
    streams = [make_row("odometry", 1.0, 116, generated=1).stream] * 2_000
    new = count_new(1.0, streams, (LIMIT,))
    assert new == len(streams)
    alone, among = interval_of(1.0, streams[0], 0.5), interval_of(1.0, streams[0], 0.5, new=new)
    assert alone == pytest.approx(1.0 / 3.0)
    assert among > 1.7
    assert count_new(9.0, [make_row("odometry", 20.0, 116).stream], (LIMIT,)) == 1


def test_what_others_do_not_tell_of_goes_on_as_it_did(make_row):
    """They tell of few streams at a time; of our own we know that they are silent."""
    stream = make_row("odometry", 20.0, 116, generated=6).stream
    audience = Audience.of(116, 0.01, 0.0, (Receiver(),))
    intervals = [row_of(until, stream, audience, 1, (LIMIT,), own=False).interval for until in (0.25, 9.0)]
    assert intervals == pytest.approx([0.05, 9.0 / 8])


def test_what_shows_too_much_is_not_hopeless(make_row):
    """What is worth next to nothing pays by what it ends; what has nothing to end does not."""
    cameras = [make_row("camera", 10.0, 26_000) for _ in range(4)]
    rows = make_row("finding", 5.0, 20_000), make_row("finding", 5.0, 20_000, shown=5.0), *cameras
    assert standings(*rows)[:2] == [Standing.HOPELESS, Standing.CONTESTED]


def test_a_sample_of_a_priced_stream_pays_out_of_turn_where_it_ends_enough(make_row):
    """What is lost until the stream would send anyhow is compared with what its room costs."""
    rows = [make_row("finding", 20.0, 1_000, scale=1.0) for _ in range(20)]
    (one, *_) = weighed(*rows)
    assert one.standing is Standing.PRICED
    assert one.relief == 1.0
    enough = one.cost / one.apart
    assert [one.relieves(part * enough) for part in (0.0, 0.9, 1.1)] == [False, False, True]
    (other, *_) = weighed(*[make_row("odometry", 20.0, 1_000) for _ in range(20)])
    assert not other.relieves(1e9)


def test_a_plan_decides_on_messages_of_middling_size_if_it_can_hold_all_of_them(make_row):
    """By a price alone room is kept for whole ones: of twenty to a window that is a twentieth of it."""

    def contested(count, size):
        return sum(each is Standing.CONTESTED for each in standings(*[make_row("odometry", 20.0, size)] * count))

    assert contested(1, 2_500) == 0  # there is room for all
    assert contested(3, 2_500) == 3
    assert contested(3, 1_000) == contested(4, 2_500) == 0


def test_what_varies_leaves_room_for_the_rest(make_row):
    """Else the last of many small samples, worth little, take what a window with more than usual needs for others."""

    def prices(*rows):
        return Market.of(rows, (LIMIT,), HORIZON)[0].prices

    even, uneven = ([make_row("odometry", 20.0, 1_000, deviation=d) for _ in range(20)] for d in (0.0, 900.0))
    assert prices(*uneven) > prices(*even) > (0.0,)
    cameras = [[make_row("camera", 10.0, 26_000, deviation=d) for _ in range(4)] for d in (0.0, 9_000.0)]
    small = make_row("odometry", 20.0, 116)
    assert prices(*cameras[0], small) == prices(*cameras[1], small)
    assert standings(*cameras[1], small)[-1] is Standing.UNDISPUTED
