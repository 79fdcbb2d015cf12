"""The planning window."""

from dataclasses import replace

from planner import SearchSettings, start
from planner.native_tables import NativeTables
from planner.tables import tabulate
from proxy.core.model.limits import Limits
from proxy.core.window.window import WindowBuilder
from tests.proxy.core.window.views import (
    LIMIT,
    add_stream,
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
    problem, full, _ = builder.build(10.0, sample(10.0), waiting, union(), 61)
    assert problem == whole
    assert full == sum(not m.sent for m in whole.messages) - 1
