"""The planning window: who competes in it, and how many messages it may hold."""

import math
from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from planner import SearchSettings, start
from planner.native_tables import NativeTables
from planner.tables import tabulate
from proxy.core.model.limits import Limits
from proxy.core.view.stream import Generated, Sent
from proxy.core.window.tuning import TUNING
from proxy.core.window.window import WindowBuilder, WindowSize
from tests.proxy.core.window.views import (
    LIMIT,
    MODEL,
    add_stream,
    aggregated,
    make_view,
    sample,
    union,
)


def test_the_window_holds_the_current_message_and_everyones_forecasts(crowd):
    """At most `horizon` messages, in order of generation; the current one is ours, now."""
    problem = WindowBuilder(crowd, 0.0).build(10.0, sample(10.0), (), union())[0]
    current = problem.messages[problem.current]
    assert (current.t_gen, current.t_sent, current.use) == (10.0, 10.0, (1000.0,))
    assert len(problem.streams) == 3
    assert sum(not m.sent for m in problem.messages) <= 61
    assert {m.stream for m in problem.messages} == {0, 1, 2}
    assert problem.t_end > problem.messages[-1].t_gen
    start(problem, SearchSettings()).run(10)


def test_a_window_is_tabulated_in_c(crowd):
    """Whatever it knows of its limits besides: with NumPy it would take ten times as long, and nobody would notice."""
    problem = WindowBuilder(crowd, 0.0).build(10.0, sample(10.0), (), union())[0]
    assert isinstance(tabulate(problem, beyond=True), NativeTables)


def test_where_each_robot_has_a_part_only_our_own_streams_are_decided(crowd):
    """What we leave nobody else can use; what others sent counts against their parts."""
    part = replace(LIMIT, limit=3000.0)
    limits = Limits((part,), ((9.8, (1000.0,)),), alone=True)
    problem = WindowBuilder(crowd, 0.0).build(10.0, sample(10.0), (), limits)[0]
    assert len(problem.streams) == 1
    assert [limit.limit for limit in problem.constraints] == [3000.0]
    assert [traffic.use for traffic in problem.traffic] == [(1000.0,)]
    assert problem.messages[problem.current].use == (1000.0,)


def test_samples_that_wait_are_decided_with_it(crowd):
    """They are ours and generated; only one of them is the current one."""
    add_stream(crowd, "r1", key="robot/x/camera")
    waiting = [sample(9.9, "robot/x/camera", number=2), sample(9.9, "no/such/stream", number=3)]
    problem = WindowBuilder(crowd, 0.0).build(10.0, sample(10.0), waiting, union())[0]
    assert problem.messages[0].t_gen == 9.9
    assert problem.messages[0].t_sent == 10.0
    assert problem.messages[problem.current].t_gen == 10.0


def test_a_window_with_room_enough_is_whole(crowd):
    """Nothing changes while decisions come in time."""
    builder = WindowBuilder(crowd, 0.0)
    waiting = [sample(9.9, number=2)]
    whole = builder.build(10.0, sample(10.0), waiting, union())[0]
    problem, _, full, _ = builder.build(10.0, sample(10.0), waiting, union(), 61)
    assert problem == whole
    assert full == sum(not m.sent for m in whole.messages) - 1


@pytest.mark.parametrize("aggregation", ['"best"', '"sum"', '"once"'])
def test_all_waiting_samples_of_a_stream_are_decided_together(make_specs, aggregation):
    """Each with its own scale; the forecasts of `best` are bounded."""
    view, _ = aggregated(make_specs, aggregation, horizon=100)
    waiting = [sample(9.0 + 0.01 * i, scale=float(i), number=i) for i in range(1, 30)]
    problem = WindowBuilder(view, 0.0).build(10.0, sample(9.0), waiting, union())[0]
    past = [m.scale for m in problem.messages if m.t_gen < 10.0]
    assert past == [1.0, *(float(i) for i in range(1, 30))]
    assert problem.messages[problem.current].t_gen == 9.0
    coming = sum(m.t_gen > 10.0 for m in problem.messages)
    assert (
        coming in {39, 40}
        if aggregation != '"best"'
        else TUNING.forecasts_of_best // 2 < coming <= TUNING.forecasts_of_best
    )


def test_of_a_model_of_the_operators_few_messages_are_weighed(make_specs):
    """The most valuable that wait, and forecasts as far apart as it takes: few enough for a whole table."""
    view, _ = aggregated(make_specs, MODEL)
    waiting = [sample(9.0 + 0.01 * i, scale=float(i % 7), number=i) for i in range(1, 30)]
    problem = WindowBuilder(view, 0.0).build(10.0, sample(9.0), waiting, union())[0]
    opened = [m for m in problem.messages if not m.sent]
    assert [m.scale for m in opened if m.t_gen < 10.0] == [1.0] + [6.0] * TUNING.messages_of_a_model
    assert 1 <= sum(m.t_gen > 10.0 for m in opened) <= TUNING.messages_of_a_model
    assert tabulate(problem).gains.closed


def two_cameras(make_specs, horizon):
    """Return when the messages of two streams of ten samples a second are generated, of which one is worth more [s]."""
    view = make_view(make_specs(), horizon=horizon)
    view.subscribers.set_own(("robot/**",))
    add_stream(view, "r1", period=0.1, scale=1.0)
    add_stream(view, "r2", period=0.1, scale=50.0)
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), union())[0]
    return [[m.t_gen for m in problem.messages if m.stream == stream] for stream in (0, 1)]


def test_a_window_reaches_less_far_where_it_would_hold_too_much(make_specs):
    """It looks four constraint windows ahead, less where these are too many messages: none is left out."""
    whole, less = two_cameras(make_specs, 120), two_cameras(make_specs, 40)
    assert [times[-1] >= 13.8 for times in whole] == [True, True]
    assert sum(map(len, less)) <= 41
    assert [times == all_times[: len(times)] for times, all_times in zip(less, whole, strict=True)] == [True, True]


def test_streams_of_low_value_are_thinned_where_one_constraint_window_is_too_much(make_specs):
    """The window reaches one constraint window ahead whatever the horizon; the best stream stays whole."""
    times = two_cameras(make_specs, 12)
    assert len(times[0]) + len(times[1]) <= 13
    assert times[1][-1] >= 10.8
    assert len(times[1]) > len(times[0])


def test_one_forecast_of_every_stream_is_kept(make_specs):
    """Of as many as the window has places for."""
    view = make_view(make_specs(), horizon=3)
    view.subscribers.set_own(("robot/**",))
    for robot in ("r1", "r2", "r3"):
        add_stream(view, robot)
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), union())[0]
    assert {m.stream for m in problem.messages if not m.sent} == {0, 1, 2}


def chosen(view):
    """Return how long after 9.9 s the streams of other robots in the window generate next."""
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), union())[0]
    ours = problem.messages[problem.current].stream
    return {round(m.t_gen - 9.9, 3) for m in problem.messages if m.stream != ours}


def test_of_too_many_streams_the_best_and_the_next_ones_have_places(make_specs):
    """Half of the places each, beside the stream that is decided."""
    view = make_view(make_specs(), horizon=4)
    view.subscribers.set_own(("robot/**",))
    for number in range(8):
        period = 0.25 + 0.01 * number
        stream = view.streams.touch(9.9, f"x{number}", f"robot/x{number}/camera")
        for count in range(8):
            t_gen = 9.9 + (count - 7) * period
            stream.note_generated(count + 1, Generated(t_gen, 1000, 6.0 if number >= 6 else 1.0))
    add_stream(view, "r1", period=2.0, scale=0.1)
    assert chosen(view) == {0.31, 0.32, 0.25, 0.26}


def test_the_stream_that_is_decided_always_has_a_place(make_specs):
    """However little it is worth, and however late it generates."""
    view = make_view(make_specs(), horizon=4)
    view.subscribers.set_own(("robot/**",))
    for number in range(8):
        add_stream(view, f"x{number}", scale=2.0)
    add_stream(view, "r1", period=2.0)
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), union())[0]
    assert len(problem.streams) == 5
    assert problem.messages[problem.current].scale == 1.0


@hypothesis_settings(deadline=None, max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(most=st.integers(1, 90), streams=st.integers(1, 30), queued=st.integers(0, 40))
def test_a_window_that_must_be_small_keeps_what_matters(make_specs, most, streams, queued):
    """The current message, what was sent, and of the samples that wait those worth most."""
    view = make_view(make_specs(), horizon=60)
    view.subscribers.set_own(("robot/**",))
    for number in range(streams):
        stream = add_stream(view, "r1", key=f"robot/{number}/camera", scale=1.0 + number)
        stream.note_sent(1, Sent(9.5, 9.5, 1000, 1.0, {}))
    waiting = [sample(9.0 + 0.01 * n, "robot/0/camera", scale=1.0 + n, number=2 + n) for n in range(queued)]
    current = sample(10.0, "robot/0/camera")
    problem, _, full, _ = WindowBuilder(view, 0.0).build(10.0, current, waiting, union(), most)
    opened = [m for m in problem.messages if not m.sent]
    assert problem.messages[problem.current].t_gen == 10.0
    assert len(opened) - 1 <= max(most, 1) + 1
    kept = {m.scale for m in opened if m.t_gen < 10.0}
    assert kept == {w.scale for w in waiting[queued - len(kept) :]}
    assert len(kept) == min(queued, most // 2)
    assert len([m for m in problem.messages if m.sent]) == len(problem.streams)
    assert len(opened) - 1 <= full


def test_without_a_deadline_windows_hold_everything():
    """Whoever drives the core without one has all the time."""
    size = WindowSize(math.inf)
    size.note(1000, 10.0, thinned=False)
    assert size.messages == math.inf


def test_a_deadline_that_is_short_leaves_fewer_from_the_start():
    """The first decisions are to come in time, too."""
    assert WindowSize(1e-4).messages == TUNING.fewest_messages
    assert TUNING.fewest_messages < WindowSize(0.005).messages < WindowSize(0.02).messages


def test_decisions_that_took_too_long_make_windows_smaller_and_one_in_time_larger():
    """At most by half at once, and larger only if something was left out."""
    size = WindowSize(0.02)
    before = size.messages
    size.note(60, 0.005, thinned=False)
    assert size.messages == before
    for _ in range(TUNING.overruns):
        size.note(60, 1.6 * TUNING.overhead * 0.02, thinned=False)
    assert size.messages == 37
    for _ in range(TUNING.overruns):
        size.note(37, 5.0, thinned=True)
    assert size.messages < 18
    smallest = size.messages
    size.note(18, 0.001, thinned=True)
    assert smallest < size.messages < 1.2 * smallest


def test_a_delay_now_and_then_leaves_windows_as_they_are():
    """On a busy machine single decisions take long, however small their windows."""
    size = WindowSize(0.02)
    before = size.messages
    for number in range(40):
        size.note(60, math.inf if number % TUNING.overruns else 0.001, thinned=False)
    assert size.messages == before


@given(st.lists(st.tuples(st.integers(0, 500), st.floats(0.0, 5.0) | st.just(math.inf), st.booleans()), max_size=60))
def test_some_messages_always_have_places(decisions):
    """Whatever decisions take, even where they never come."""
    size = WindowSize(0.02)
    for held, overhead, thinned in decisions:
        size.note(held, overhead, thinned=thinned)
        assert TUNING.fewest_messages <= size.messages < math.inf


@given(st.floats(1e-5, 2e-3), st.integers(50, 400))
def test_windows_find_the_size_that_comes_in_time(each, full):
    """Where what they take grows with the messages, for any price of one: they are in time, and not far too small."""
    size = WindowSize(0.02)
    for _ in range(100):
        held = min(full, int(size.messages))
        size.note(held, each * held, thinned=held < full)
    fitting = TUNING.overhead * 0.02 / each
    assert (
        min(full, max(TUNING.fewest_messages, 0.4 * fitting))
        <= min(full, size.messages)
        <= max(TUNING.fewest_messages, 1.2 * fitting)
    )
