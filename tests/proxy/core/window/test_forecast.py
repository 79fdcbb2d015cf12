"""Which messages are expected, of whom since when, and how far ahead."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from proxy.core.model.settings import broadcast
from proxy.core.protocol.messages import State
from proxy.core.view.stream import Generated, Sent
from proxy.core.window.tuning import TUNING
from proxy.core.window.window import WindowBuilder
from tests.proxy.core.window.views import (
    add_stream,
    make_view,
    sample,
    union,
)


def test_others_messages_that_would_have_been_announced_are_decisions_only_as_long_as_that_takes(make_specs):
    """The latency, its margin, and what the stream is late by now and then; what was not announced was not sent."""
    view = make_view(make_specs())
    view.subscribers.set_own(("robot/**",))
    add_stream(view, "r1")
    late = TUNING.overheard_within + add_stream(view, "r2").schedule.jitter

    def past(now):
        problem = WindowBuilder(view, 0.0).build(now, sample(now), (), union())[0]
        return [(m.stream, m.t_gen) for m in problem.messages if m.t_gen < now]

    assert past(10.5 + 0.9 * late) == [(1, pytest.approx(10.5))]
    assert past(10.5 + 1.1 * late) == []


def test_what_a_lesser_claim_may_have_had_sent_is_no_decision(make_specs):
    """It gives way to us: where all took each other's samples for sent nobody would send any.

    Where all plans say the same they say that nobody gives way.
    """
    view = make_view(make_specs())
    view.subscribers.set_own(("robot/**",))
    ours, other = add_stream(view, "r1"), add_stream(view, "r2")

    def past(now, *, agreed=False):
        limits = replace(union(), agreed=agreed)
        problem = WindowBuilder(view, 0.0).build(now, sample(now), (), limits)[0]
        return [m.t_gen for m in problem.messages if m.t_gen < now and not m.sent]

    view.traffic.note_sent(ours, 1, Sent(9.5, 9.5, 1000, 1.0))
    view.traffic.note_sent(other, 1, Sent(9.0, 9.0, 1000, 1.0))
    assert past(10.505) == [pytest.approx(10.5)]
    view.traffic.note_sent(other, 2, Sent(9.6, 9.6, 1000, 1.0))
    assert past(10.505) == []
    assert past(10.505, agreed=True) == [pytest.approx(10.5)]


def test_who_overhears_takes_what_was_not_heard_in_time_for_not_sent(make_specs):
    """In time is the latency, its margin, and what the stream is late by now and then."""
    group = broadcast("224.0.0.226:7449")
    view = make_view(make_specs(), transport=group)
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", (), ("robot/**",), transport=group))
    add_stream(view, "r1")
    other = add_stream(view, "r2")
    view.subscribers.set_own(("robot/**",))
    late = TUNING.overheard_within + other.schedule.jitter

    def past(now):
        problem = WindowBuilder(view, 0.0).build(now, sample(now), (), union())[0]
        return [m.t_gen for m in problem.messages if m.t_gen < now]

    assert past(10.5 + 0.9 * late) == [pytest.approx(10.5)]
    assert past(10.5 + 1.1 * late) == []


TRENDING = """
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
utility = { kind = "linear", slope = 0.1 }
scale = "10 * red"
features.red = { kind = "color_fraction", color = "red" }
forecast = { features = { red = "trend" } }
"""


def test_what_is_forecast_is_worth_what_its_features_will_be(make_specs):
    """Of our own streams by features, of others' by the scale that they tell."""
    view = make_view(make_specs(text=TRENDING))
    view.subscribers.set_own(("robot/**",))
    for robot in ("r1", "r2"):
        stream = view.streams.touch(10.0, robot, f"robot/{robot}/camera")
        stream.matching = True
        for count in range(11):
            features = {"red": 0.01 * count} if robot == "r1" else {}
            stream.note_generated(count + 1, Generated(float(count), 1000, 0.1 * count, features))
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), union())[0]
    ours = [(m.t_gen, m.scale) for m in problem.messages if m.stream == 0][1:3]
    others = [(m.t_gen, m.scale) for m in problem.messages if m.stream == 1][:2]
    assert np.array(ours) == pytest.approx(np.array([(11.0, 1.1), (12.0, 1.4)]))
    assert np.array(others) == pytest.approx(np.array(ours))


def test_others_random_samples_are_expected_from_now_on(make_specs):
    """As nothing was heard of any since, there was none."""
    spec = TRENDING.replace('features = { red = "trend" }', 'schedule = { kind = "poisson", interval = 3 }')
    view = make_view(make_specs(text=spec))
    view.subscribers.set_own(("robot/**",))
    for robot in ("r1", "r2"):
        add_stream(view, robot, size=3000)
    problem = WindowBuilder(view, 0.0).build(12.5, sample(12.5), (), union())[0]
    assert [m.t_gen for m in problem.messages if m.stream == 1] == [15.5]


def offered(make_specs, sizes, *, robots=4, kind="", scales=(1.0,), alone=False):
    """Robots with frames of 10 Hz of these sizes, and worths, in turn, under a limit of 4 kB/s; what is expected."""
    view = make_view(make_specs(), horizon=400)
    for robot in range(robots):
        stream = view.streams.touch(10.0, f"r{robot + 1}", f"robot/r{robot + 1}/camera")
        stream.matching = True
        for count in range(100):
            stream.note_generated(
                count + 1, Generated(0.1 * count + 0.02 * robot, sizes[count % len(sizes)], scales[robot % len(scales)])
            )
        if kind:
            stream.schedule.assume(0.1, kind)
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), [], replace(union(), alone=alone))[0]
    return [m for m in problem.messages if not m.sent and m.t_gen > 10.0]


def test_where_far_more_is_offered_than_fits_only_the_smallest_samples_are_expected_to_be_sent(make_specs):
    """So few as are needed to use the limit up, and as small: no frame of usual size takes the room of two of them."""
    messages = offered(make_specs, (1800, 2000, 2200))
    carried = 4_000.0 / (4 * 10 * 2_000.0)
    until = max(m.t_gen for m in messages)
    assert len(messages) == pytest.approx(TUNING.offered * carried * 40 * (until - 10.0), rel=0.2)
    assert [m.use[0] for m in messages] == pytest.approx([1690.0] * len(messages), abs=30.0)


@pytest.mark.parametrize(
    ("sizes", "robots", "kind"),
    [((2000,), 4, ""), ((180, 200, 220), 4, ""), ((900, 1000, 1100), 1, ""), ((1800, 2000, 2200), 4, "poisson")],
    ids=["alike", "small", "few", "at random"],
)
def test_else_all_samples_are(make_specs, sizes, robots, kind):
    """Where sizes are alike, or small beside the limit, or where most of them fit, nothing is gained by waiting."""
    messages = offered(make_specs, sizes, robots=robots, kind=kind)
    assert len(messages) >= 0.9 * robots * 10 * (max(m.t_gen for m in messages) - 10.0) - robots


def test_within_a_part_of_our_own_all_samples_are_expected(make_specs):
    """Where a later one was expected each time, small samples took the room of the one that came."""
    few, every = (offered(make_specs, (1800, 2000, 2200), robots=1, alone=alone) for alone in (False, True))
    assert len(few) < 0.5 * len(every)
    assert [m.t_gen - 10.0 for m in every] == pytest.approx([0.1 * (n + 1) for n in range(len(every))], abs=0.01)


def test_samples_of_little_worth_do_not_count_where_better_ones_are_chosen(make_specs):
    """A part of the better ones fit; were all four streams alike, as few of each would be expected."""
    count = Counter(m.stream for m in offered(make_specs, (1350, 1500, 1650), scales=(1.0, 0.1, 0.1, 0.1)))
    best, *others = sorted(count.values(), reverse=True)
    assert best >= 2 * max(others)
