"""The figures on runs made by hand, whose figures are known."""

import math
from dataclasses import replace

import numpy as np
import pytest

from studies.demo.events import Counts, Links, Publish, Receive, Run, Serve
from studies.demo.figures import figures

START = 100.0
RATE, LIMIT, WINDOW = 80_000.0, 8_000.0, 1.0
RUN = Run("with", START, 4.0, ("r1",), RATE, LIMIT, WINDOW)


def published(number, t, size=1000, red=0.0, robot="r1"):
    return Publish("with", robot, number, START + t, size, red)


def received(number, t, t_gen, size=1000, robot="r1"):
    return Receive("with", robot, number, START + t, START + t_gen, size)


# One robot publishes every second and sees red from 2 s on; the frames 0, 2 and 3 arrive, the last too late.
HANDMADE = [
    RUN,
    *(published(number, float(number), red=0.3 if number >= 2 else 0.0) for number in range(4)),
    received(0, 0.5, 0.0),
    received(2, 2.1, 2.0),
    received(3, 4.5, 3.0),
    Serve("with", START - 1.0, "r1", "operator", 500),
    Serve("with", START + 0.2, "r1", "operator", 600),
    Serve("with", START + 0.4, "operator", "r1", 50),
    Serve("with", START + 2.0, "r1", "operator", 1000),
    Counts("with", "r1", 4, 3, 1, 0),
    Links("with", START + 1.0, 2, 0),
    Links("with", START + 2.0, 2, 2),
    Links("with", START + 3.0, 2, 1),
]


def of(events):
    return figures(events)["with"]


def without(events):
    """The figures of the same events in a run without the filter, where nobody counts."""
    ran = [replace(event, phase="without") for event in events if not isinstance(event, Counts)]
    return figures(ran)["without"]


def video(age):
    """Eq. 9's utility by its definition."""
    if age >= 10.0:
        return 0.0
    return 1.0 if age <= 1 / 30 else 1.0 - math.log(age * 30) / math.log(300)


def worth(scale, start, end):
    """∫ of the video utility between two ages, by the midpoint rule."""
    edges = np.linspace(start, end, 20_001)
    return scale * sum(video(age) for age in (edges[1:] + edges[:-1]) / 2) * (end - start) / 20_000


def test_rates_and_ages_are_those_of_the_frames_that_arrived_in_time():
    """Red and other frames apart; what arrives after the end does not count."""
    found = of(HANDMADE)
    assert (found["seconds_red"], found["seconds_other"]) == pytest.approx((2.0, 2.0))
    assert (found["fps_red"], found["fps_other"]) == pytest.approx((0.5, 0.5))
    assert found["fps_ratio"] == pytest.approx(1.0)
    assert (found["age_p50_red"], found["age_p95_red"]) == pytest.approx((0.1, 0.1))
    assert (found["age_p50_other"], found["age_p95_other"]) == pytest.approx((0.5, 0.5))


def test_staleness_is_the_age_of_what_is_shown_when_one_looks():
    """Looked at 20 times a second, by what the robot sees at that moment."""
    found = of(HANDMADE)
    other = [t / 20 for t in range(40)]  # frame 0, or nothing yet, is on the screen
    red = [t / 20 - (0.0 if t / 20 < 2.1 else 2.0) for t in range(40, 80)]
    assert found["staleness_p50_other"] == pytest.approx(np.percentile(other, 50))
    assert found["staleness_p95_other"] == pytest.approx(np.percentile(other, 95))
    assert found["staleness_p50_red"] == pytest.approx(np.percentile(red, 50))
    assert found["staleness_p95_red"] == pytest.approx(np.percentile(red, 95))


def test_utility_is_the_integral_of_what_is_shown():
    """Eq. 9: video utility, scaled by 1 + 10 × red, from each receipt to the next or the end; nothing red is gone."""
    gained = worth(1.0, 0.5, 2.1) + worth(4.0, 0.1, 2.0)
    ideal = 2 * worth(1.0, 0.0, 1.0) + 2 * worth(4.0, 0.0, 1.0)
    found = of(HANDMADE)
    assert found["utility"] == pytest.approx(gained, rel=1e-4)
    assert found["utility_share"] == pytest.approx(gained / ideal, rel=1e-4)


def test_red_that_is_gone_is_lost_until_a_later_frame_is_shown():
    """It is gone at 2 s, and the frame that says so arrives at 3.5; a screen that never says so counts to the end."""
    events = [
        RUN,
        *(published(number, float(number), red=0.3 if number < 2 else 0.0) for number in range(4)),
        received(1, 1.5, 1.0),
        received(3, 3.5, 3.0),
    ]
    found = of(events)
    assert found["end_p95"] == pytest.approx(1.5)
    assert found["false_red"] == pytest.approx(1.5)
    assert found["utility"] == pytest.approx(worth(4.0, 0.5, 2.5) + worth(1.0, 0.5, 1.0) - 3.0 * 1.5, rel=1e-4)
    never = of(events[:-1])
    assert never["end_p95"] == pytest.approx(2.0)
    assert never["false_red"] == pytest.approx(2.0)
    assert of(HANDMADE)["end_p95"] is None
    assert of(HANDMADE)["false_red"] == 0.0


def test_the_optimum_takes_what_the_limit_allows():
    """One frame fits a window; windows are closed, so of four frames a second apart only some may go."""
    pytest.importorskip("scipy")
    found = of(HANDMADE)
    assert found["utility_share_optimum"] is not None
    # Half a second late, the frames that arrived are worth less than the best two.
    assert found["utility_share"] < found["utility_share_optimum"] < 1.0
    unlimited = [Run("with", START, 4.0, ("r1",), RATE, 1e9, WINDOW), *HANDMADE[1:]]
    ideal = 2 * worth(1.0, 0.1, 1.1) + worth(4.0, 0.1, 1.1) + worth(4.0, 0.1, 1.0)
    assert of(unlimited)["utility_share_optimum"] == pytest.approx(found["utility"] / ideal, rel=1e-3)
    assert of(unlimited)["fps_ratio_optimum"] == pytest.approx(1.0)


def test_the_medium_is_measured_within_the_run():
    """Bytes of both directions between start and end; the fullest window against what the spec allows."""
    found = of(HANDMADE)
    assert found["medium_bytes"] == 1650
    assert found["medium_max_share"] == pytest.approx(1.0)
    assert found["published_bytes"] == 4000
    assert found["received_bytes"] == 2000
    # The frames 0 and 2 are two seconds apart: no window holds both.
    assert found["offered_max_share"] == pytest.approx(1.0)


def test_a_frame_that_waits_counts_when_it_is_sent():
    """Two that were published apart and sent together fill a window; what daemons say in between is no frame."""
    events = [
        RUN,
        *(published(number, 1.5 * number) for number in range(2)),
        *(received(number, 1.7 + number / 10, 1.5 * number) for number in range(2)),
        *(Serve("with", START + t, "r1", "operator", 60) for t in (0.1, 1.55)),
        *(Serve("with", START + t, "r1", "operator", 1000) for t in (0.9, 1.6, 1.75)),
        Counts("with", "r1", 2, 2, 0, 0),
    ]
    assert of(events)["offered_max_share"] == pytest.approx(2.0)
    assert without(events)["offered_max_share"] == pytest.approx(1.0)


def test_without_the_filter_everything_is_offered():
    """Stock routers count nothing, and four frames a second apart fill a closed window twice."""
    found = without(HANDMADE)
    assert found["conserved"] is None
    assert found["offered_max_share"] == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("counts", "conserved"),
    [((4, 3, 1, 0), True), ((4, 2, 1, 1), True), ((4, 2, 1, 0), False), ((3, 2, 1, 0), False)],
)
def test_counts_must_add_up_to_what_was_published(counts, conserved):
    """Neither a sample without fate nor one that was never counted passes."""
    events = [event for event in HANDMADE if not isinstance(event, Counts)]
    assert of([*events, Counts("with", "r1", *counts)])["conserved"] is conserved


def test_what_went_around_the_medium_is_found():
    """By connections, the most that were ever seen, and by bytes received but never carried."""
    found = of(HANDMADE)
    assert found["direct_links"] == 2
    assert found["direct_bytes"] == 0
    nothing_carried = [event for event in HANDMADE if not isinstance(event, Serve)]
    assert of(nothing_carried)["direct_bytes"] == 2000


def test_figures_without_red_are_left_out():
    """No division by the time that nobody saw red."""
    found = of([RUN, published(0, 0.5), published(1, 1.5), received(1, 1.6, 1.5)])
    assert found["fps_red"] is None
    assert found["age_p95_red"] is None
    assert found["staleness_p95_red"] is None
    assert found["fps_ratio"] is None
    assert found["fps_other"] == pytest.approx(1 / 3.5)


def test_a_robot_whose_frames_never_arrive_gains_nothing():
    """Its screen stays dark: staleness grows from its first frame on."""
    found = of([RUN, published(0, 0.0), published(1, 2.0)])
    assert found["utility"] == 0.0
    assert found["age_p50_other"] is None
    assert found["staleness_p95_other"] == pytest.approx(np.percentile([t / 20 for t in range(80)], 95))


def test_events_without_their_conditions_are_refused():
    """Nothing can be said about a run of unknown length."""
    with pytest.raises(ValueError, match='the events of "with" do not say under which conditions'):
        figures(HANDMADE[1:])


def test_the_operator_sees_something_red_when_its_first_frame_comes_or_a_later_one():
    """Of one event, 0.1 s after it began; the oldest screen is that before it."""
    found = of(HANDMADE)
    assert found["events"] == 1
    assert found["start_p95"] == pytest.approx(0.1)
    assert found["staleness_max"] == pytest.approx(2.1, abs=0.06)
    late = of([event for event in HANDMADE if not (isinstance(event, Receive) and event.number == 2)])
    assert late["start_p95"] == pytest.approx(2.0)
