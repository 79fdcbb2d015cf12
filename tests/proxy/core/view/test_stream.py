"""One stream: what is expected of its next samples."""

import numpy as np
import pytest

from proxy.core.view.stream import Generated, Sent, Sizes, Stream, at_stake, excess
from proxy.core.view.tuning import TUNING
from tests.proxy.core.view.met import CAMERA

TRENDING = """
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
utility = {{ kind = "linear", slope = 0.1 }}
scale = "1 + 10 * red"
features.red = {{ kind = "color_fraction", color = "red" }}
forecast = {forecast}
"""


@pytest.fixture
def make_stream(make_specs):
    def make(forecast, *values, features=True):
        (covering,) = make_specs(text=TRENDING.format(forecast=forecast)).types
        stream = Stream(1, "r1", "robot/r1/camera", covering)
        stream.cover(covering)
        for count, value in enumerate(values):
            told = {"red": value} if features else {}
            stream.note_generated(count + 1, Generated(float(count), 100, 1.0 + 10.0 * value, told))
        return stream

    return make


def test_unless_a_spec_says_otherwise_the_next_is_like_the_last(make_stream):
    """At no cost: it is the very same."""
    stream = make_stream('{ features = "last" }', 0.1, 0.2)
    assert stream.expected(5.0) is stream.last
    assert stream.forecasts == {}


def test_what_rises_is_expected_to_go_on_rising(make_stream):
    """At two times ahead, so that a window costs few evaluations."""
    stream = make_stream('{ features = "trend" }', *(0.02 * k for k in range(10)))
    expected = [stream.expected(9.0 + ahead) for ahead in range(1, 60)]
    assert [e.features["red"] for e in expected[:2]] == pytest.approx([0.2, 0.26])
    assert [e.scale for e in expected[:2]] == pytest.approx([3.0, 3.6])
    assert len({e.scale for e in expected}) <= len(TUNING.leads)
    assert {e.size for e in expected} == {100}
    assert stream.forecasts == {"red": "trend"}
    assert stream.expected(9.5) is stream.expected(10.0)


def test_a_mean_is_the_same_at_all_times(make_stream):
    """So it is evaluated once for each new sample."""
    stream = make_stream('{ features = { red = "mean" } }', 0.1, 0.3)
    assert stream.expected(5.0) is stream.expected(50.0)
    assert stream.expected(5.0).scale == pytest.approx(3.0)
    stream.note_generated(3, Generated(2.0, 100, 1.0, {"red": 0.8}))
    assert stream.expected(5.0).scale == pytest.approx(5.0)


def test_where_features_are_not_known_the_scale_itself_is_forecast(make_stream):
    """It is never below 0."""
    stream = make_stream('{ features = "trend" }', *(0.5 - 0.05 * k for k in range(10)), features=False)
    assert stream.expected(10.0).scale == pytest.approx(1.0)
    assert stream.expected(19.0).scale == 0.0
    assert stream.forecasts == {"scale": "trend"}


def test_another_spec_changes_schedule_and_forecast_and_keeps_what_was_seen(make_stream, make_specs):
    """What is forecast by the same methods goes on where it was."""
    stream = make_stream('{ features = "mean" }', 0.1, 0.3)
    (same,) = make_specs(
        text=TRENDING.format(forecast='{ features = "mean", schedule = { kind = "poisson", interval = 7 } }')
    ).types
    stream.cover(same)
    assert (stream.schedule.kind, stream.schedule.period) == ("poisson", 7.0)
    assert stream.expected(5.0).scale == pytest.approx(3.0)
    (plain,) = make_specs(text=TRENDING.format(forecast="{}")).types
    stream.cover(plain)
    assert (stream.schedule.kind, stream.schedule.period) == ("periodic", 1.0)
    assert stream.expected(5.0) is stream.last


MEAN, TREND = 'forecast = { features = "mean" }', 'forecast = { features = "trend" }'


@pytest.mark.parametrize(
    ("before", "after"),
    [((MEAN, "red"), (MEAN,)), ((MEAN,), (TREND,)), ((MEAN,), (MEAN, "red")), ((MEAN, "red"), (MEAN, "blue"))],
)
def test_where_other_features_are_forecast_the_next_sample_is_like_the_last_one(make_specs, before, after):
    """Until one is generated: what is known of other features says nothing of it."""

    def covering(forecast, *colors):
        features = [f'features.{color} = {{ kind = "color_fraction", color = "{color}" }}' for color in colors]
        head = '[[information_type]]\nname = "camera"\nkeys = ["robot/*/camera"]\nutility = { kind = "video" }'
        return make_specs(text="\n".join((head, forecast, *features))).types[0], dict.fromkeys(colors, 0.2)

    (old, seen), (new, seen_anew) = covering(*before), covering(*after)
    stream = Stream(1, "r1", "robot/r1/camera", old)
    stream.cover(old)
    stream.note_generated(1, Generated(1.0, 100, 1.0, seen))
    stream.cover(new)
    stream.renew(Generated(1.0, 100, 1.0, seen_anew))
    assert stream.expected(5.0) is stream.last
    stream.note_generated(2, Generated(2.0, 100, 1.0, seen_anew))
    assert stream.expected(5.0) == stream.last


def test_a_function_that_fails_in_flight_is_counted_by_its_type(make_stream):
    """The last value holds, and the status of specs can tell."""
    stream = make_stream('{ features = { python = "tests.utility_specs.outlooks:broken" } }', 0.5, 2.0)
    assert stream.expected(3.0).scale == pytest.approx(21.0)
    assert stream.information_type.failures.counts() == {"forecast": 1}


def test_a_stream_of_which_nothing_was_generated_has_no_newest(make_stream):
    """The view has none such."""
    with pytest.raises(LookupError, match="nothing was generated of robot/r1/camera yet"):
        _ = make_stream("{}").newest


def test_sends_nobody_told_us_of_are_spread_evenly():
    """A lost digest leaves a gap in the counts, not in what the air carried."""
    stream = Stream(1, "r2", CAMERA, None)
    stream.note_sent(1, Sent(1.0, 1.0, 10, 1.0))
    stream.note_sent(4, Sent(4.0, 4.0, 10, 1.0))
    assert [sent.t_sent for sent in stream.recent] == [1.0, 2.0, 3.0, 4.0]
    stream.note_sent(2, Sent(9.0, 9.0, 10, 1.0))
    assert stream.forwarded == 4
    stream.note_generated(0, Generated(1.0, 1, 1.0))
    with pytest.raises(LookupError, match="nothing was generated"):
        _ = stream.newest


def test_who_was_not_reached_after_all_is_reached_by_the_next_sample(view):
    """Though the same robots want it."""
    stream = view.streams.touch(0.0, "r1", CAMERA)
    names = ("z-r2", "z-r3")
    stream.reach(names)
    stream.miss(("z-r2",))
    assert stream.reached == {"z-r3"}
    stream.reach(names)
    assert stream.reached == set(names)


@pytest.mark.parametrize(("aggregation", "over"), [("most_recent", 0.0), ("current", 3.0)])
def test_what_was_sent_last_may_show_too_much(make_specs, aggregation, over):
    """With `current` a sample of less worth has at stake what it ends; nothing before anything was sent."""
    text = TRENDING.format(forecast='{ features = "last" }') + f'aggregation = "{aggregation}"\n'
    (covering,) = make_specs(text=text).types
    stream = Stream(1, "r1", "robot/r1/camera", covering)
    stream.note_generated(1, Generated(0.0, 100, 4.0))
    assert (excess(stream), at_stake(stream, 1.0)) == (0.0, 1.0)
    stream.note_sent(1, Sent(0.0, 0.0, 100, 4.0))
    assert excess(stream) == 0.0
    stream.note_generated(2, Generated(1.0, 100, 1.0))
    assert (excess(stream), at_stake(stream, 1.0), at_stake(stream, 9.0)) == (over, 1.0 + over, 9.0)
    stream.note_sent(2, Sent(1.0, 1.0, 100, 1.0))
    assert excess(stream) == 0.0


@pytest.mark.parametrize("part", [0.05, 0.3, 0.9])
def test_the_smallest_samples_are_so_large_in_the_mean(part):
    """By sampling; never less than a part of the mean, for no size is negative."""
    drawn = np.sort(np.random.default_rng(3).normal(1000.0, 100.0, 200_000))
    assert Sizes(1000.0, 100.0**2).smallest(part) == pytest.approx(np.mean(drawn[: int(part * len(drawn))]), rel=0.01)
    assert Sizes(1000.0, 1000.0**2).smallest(0.05) == TUNING.smallest_size_part * 1000


def test_sizes_that_do_not_vary_are_planned_with_as_they_are():
    """And smaller ones than the mean where they do, but not much smaller."""
    sizes = Sizes()
    for _ in range(3):
        sizes.note(700)
    assert (sizes.mean, sizes.deviation, sizes.likely(700)) == (700.0, 0.0, 700)
    assert Sizes(1000.0, 100.0**2).likely(1200) == round(1000.0 - 100.0 * TUNING.sent_size_deviations)
    assert Sizes(1000.0, 9000.0**2).likely(1200) == 500


def test_mean_and_variance_follow_what_comes():
    """The recent sizes count more; who knows none takes the first one for the mean."""
    sizes, drawn = Sizes(), np.random.default_rng(5).normal(2000.0, 300.0, 400)
    for size in drawn:
        sizes.note(round(size))
    assert sizes.mean == pytest.approx(2000.0, rel=0.15)
    assert 100.0 < sizes.deviation < 500.0


def test_an_announced_size_is_kept_beside_what_is_seen():
    """All robots know that one alike."""
    sizes = Sizes()
    sizes.announce(512)
    sizes.note(700)
    assert (sizes.announced, sizes.mean) == (512, 700.0)
