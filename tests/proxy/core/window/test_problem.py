"""The problem of a window: facts, times, uses and receivers."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from planner import Latest, Receiver, SearchSettings, start
from planner.measures import Energy, Messages
from proxy.core.model.limits import Limit, Limits
from proxy.core.protocol.messages import Echo, State
from proxy.core.transit.latency import Latency
from proxy.core.view.stream import Generated, Sent
from proxy.core.window.window import WindowBuilder
from tests.proxy.core.window.views import (
    BY_RED,
    LIMIT,
    MODEL,
    add_stream,
    aggregated,
    make_view,
    meet,
    plan_of,
    sample,
    union,
)


def test_what_was_sent_is_a_fact(crowd):
    """The last sent message counts for what it is still worth, all recent sends for what they use."""
    for stream in list(crowd.streams):
        stream.note_sent(1, Sent(9.4, 9.4, 1000, 2.0))
        stream.note_sent(2, Sent(9.7, 9.7, 1000, 2.0))
    sent = ((9.4, (1000.0,)), (9.7, (1000.0,)))
    limits = Limits((LIMIT,), sent, others=sent)
    problem = WindowBuilder(crowd, 0.0).build(10.0, sample(10.0), (), limits)[0]
    facts = [m for m in problem.messages if m.sent]
    assert [(m.t_gen, m.use) for m in facts] == [(9.7, (0.0,))] * 3
    assert sum(t.use[0] for t in problem.traffic) == 4000.0


def test_times_before_zero_are_times_like_others(make_specs):
    """A clock may show anything: the window is the same, and only later or earlier."""

    def window(zero):
        view = make_view(make_specs())
        view.subscribers.set_own(("robot/**",))
        for robot in ("r1", "r2"):
            stream = view.streams.touch(zero + 10.0, robot, f"robot/{robot}/camera")
            for count in range(11):
                stream.note_generated(count + 1, Generated(zero + 5.0 + 0.5 * count, 1000, 1.0))
        view.traffic.note_sent(stream, 1, Sent(zero + 9.5, zero + 9.5, 1000, 1.0))
        problem = WindowBuilder(view, zero).build(zero + 10.2, sample(zero + 10.2), (), union())[0]
        times = [t - zero for m in problem.messages for t in (m.t_gen, m.t_sent, m.t_rcv)]
        return [problem.t_start - zero, problem.t_end - zero, *times]

    assert window(-1024.0) == pytest.approx(window(0.0))


def test_a_python_utility_sees_the_features_of_each_sample(make_specs):
    """Our own of the current sample, the newest and the last sent; of others' samples the defaults."""
    view = make_view(make_specs(text=BY_RED))
    view.subscribers.set_own(("robot/**",))
    for robot in ("r1", "r2"):
        add_stream(view, robot)
    ours, others = view.streams
    ours.note_generated(100, Generated(9.9, 1000, 1.0, {"red": 3.0}))
    ours.note_sent(1, Sent(9.7, 9.7, 1000, 1.0, {"red": 2.0}))
    others.note_sent(1, Sent(9.6, 9.6, 1000, 1.0))
    problem = WindowBuilder(view, 0.0).build(10.0, replace(sample(10.0), features={"red": 4.0}), (), union())[0]
    fresh = {(m.stream, m.sent, at == problem.current): fresh_value(m) for at, m in enumerate(problem.messages)}
    assert fresh == pytest.approx(
        {
            (0, True, False): 2.0,
            (0, False, True): 4.0,
            (0, False, False): 3.0,
            (1, True, False): 0.5,
            (1, False, False): 0.5,
        }
    )


@pytest.mark.parametrize(
    ("aggregation", "facts"),
    [
        ('"most_recent"', [(9.4, 9.5)]),
        ('"sum"', []),
        ('"once"', []),
        ('"best"', [(7.9, 10.0), *((round(7.9 + 0.1 * i, 6), 10.0) for i in range(1, 16))]),
        (MODEL, [(round(7.9 + 0.1 * i, 6), round(8.0 + 0.1 * i, 6)) for i in range(16)]),
    ],
)
def test_the_facts_of_a_stream_are_those_that_matter(make_specs, aggregation, facts):
    """The last one, none, or the last sixteen; of `best`, from now on."""
    view, stream = aggregated(make_specs, aggregation)
    for count in range(20):
        t = 7.5 + 0.1 * count
        stream.note_sent(count + 1, Sent(t, t + 0.1, 1000, 1.0, {"red": 1.0}))
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), union())[0]
    found = [(round(m.t_gen, 6), round(m.t_rcv, 6)) for m in problem.messages if m.sent]
    assert found == facts
    assert problem.streams[0].aggregation is stream.information_type.aggregation
    plan_of(problem)


def test_of_once_only_the_robots_without_any_receive(make_specs):
    """One that joins is worth a message, the one that has it is not."""
    view, stream = aggregated(make_specs, '"once"')
    view.traffic.note_sent(stream, 1, Sent(9.0, 9.0, 1000, 1.0))
    view.add_peer(9.5, "r3", "z-r3")
    view.heard_state(9.5, State("r3", "z-r3", "enforce", "", (), ("robot/**",)))
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), union())[0]
    assert problem.streams[0].receivers == (Receiver(0.0, 1.0),)
    assert problem.messages[problem.current].use == (2000.0,)


def test_what_others_sent_of_once_still_uses_the_channel(make_specs):
    """Though nobody gains by more of it, so that it is no stream of the problem."""
    view, _ = aggregated(make_specs, '"once"')
    others = add_stream(view, "r2")
    view.traffic.note_sent(others, 1, Sent(9.7, 9.7, 1000, 1.0))
    assert view.traffic.sent_since(9.0) == [(9.7, (1000, 1), "r2", True)]
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), union())[0]
    assert len(problem.streams) == 1


def test_receivers_of_our_own_stream_are_told_apart_by_latency(crowd):
    """Those of which we know nothing get messages like the others; no message has their number in its scale."""
    for robot, latency in (("r2", 0.02), ("r3", 0.1), ("r4", 0.02)):
        crowd.add_peer(0.0, robot, f"z-{robot}")
        crowd.heard_state(0.0, State(robot, f"z-{robot}", "enforce", "", (), ("robot/**",)))
        crowd.peers[f"z-{robot}"].outbound.latency = Latency(latency)
    problem = WindowBuilder(crowd, 0.0).build(10.0, sample(10.0), (), union())[0]
    ours, others, _ = problem.streams
    assert ours.receivers == (Receiver(0.0, 2.0), Receiver(pytest.approx(0.08), 1.0))
    assert others.receivers == (Receiver(0.0, 3.0),)
    current = problem.messages[problem.current]
    assert (current.t_rcv, current.scale) == (pytest.approx(10.02), 1.0)
    assert problem.t_end > max(m.t_rcv for m in problem.messages) + 0.08


def test_a_message_arrives_the_later_the_larger_it_is(crowd):
    """The time to a receiver has a part per byte, for what is decided as for what was sent."""
    meet(crowd, Latency(0.02, 1e-5))
    stream = crowd.streams.touch(0.0, "r1", "robot/r1/camera")
    stream.note_sent(1, Sent(9.0, 9.0, 21_000, 1.0))
    problem = WindowBuilder(crowd, 0.0).build(10.0, replace(sample(10.0), size=11_000), (), union())[0]
    (fact,) = [m for m in problem.messages if m.sent and m.stream == 0]
    assert fact.t_rcv == pytest.approx(9.0 + 0.02 + 0.21)
    assert problem.messages[problem.current].t_rcv == pytest.approx(10.0 + 0.02 + 0.11)


def test_what_gets_lost_is_worth_less(crowd):
    """A receiver counts by the part of our samples that it is expected to get."""
    peer = meet(crowd, Latency(0.02))
    for at, sent, received in ((1.0, 0, 0), (2.0, 100, 75)):
        peer.outbound.sent = sent
        peer.outbound.sent_digest(at)
        peer.outbound.heard_echo(at + 0.1, Echo("z-r1", at, at, received, 0.02))
    problem = WindowBuilder(crowd, 0.0).build(10.0, sample(10.0), (), union())[0]
    assert problem.streams[0].receivers == (Receiver(0.0, pytest.approx(0.75)),)


@hypothesis_settings(deadline=None, max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    robots=st.integers(1, 6),
    latency=st.floats(0.001, 0.5),
    scale=st.floats(0.1, 10.0),
    ages=st.lists(st.floats(0.1, 4.0), max_size=4),
    limit=st.floats(2_000.0, 40_000.0),
)
def test_equal_latencies_give_the_plan_of_one_receiver_that_counts_for_all(
    make_specs, *, robots, latency, scale, ages, limit
):
    """As if each message were worth so many times as much to one."""
    view = make_view(make_specs())
    for number in range(robots):
        view.add_peer(0.0, f"p{number}", f"z-{number}")
        view.heard_state(0.0, State(f"p{number}", f"z-{number}", "enforce", "", (), ("robot/**",)))
        view.peers[f"z-{number}"].outbound.latency = Latency(latency)
    stream = add_stream(view, "r1")
    for count, age in enumerate(sorted(ages, reverse=True)):
        stream.note_sent(count + 1, Sent(10.0 - age, 10.0 - age, 1000, 1.0))
    limits = Limits((replace(LIMIT, limit=limit),))
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0, scale=scale), (), limits)[0]
    assert problem.streams[0].receivers == (Receiver(0.0, float(robots)),)
    merged = replace(
        problem,
        streams=tuple(each._replace(receivers=(Receiver(),)) for each in problem.streams),
        messages=tuple(m._replace(scale=m.scale * robots) for m in problem.messages),
    )
    found, expected = plan_of(problem), plan_of(merged)
    assert found.utility == pytest.approx(expected.utility)
    assert found.send == expected.send or abs(expected.lead) <= 1e-6 * expected.utility


def fresh_value(message) -> float:
    return float(message.utility.value(np.zeros(1))[0])


def test_others_use_nothing_of_our_energy(make_specs):
    """Their forecasts and what they sent count by the shared measures alone."""
    view = make_view(make_specs())
    view.subscribers.set_own(("robot/**",))
    for robot in ("r1", "r2"):
        add_stream(view, robot).note_sent(1, Sent(9.7, 9.7, 1000, 2.0))
    energy = Limit("energy", 1.0, 10.0, Energy(10.0, 1.0, per_byte=1e-3))
    count = Limit("messages", 1.0, 10.0, Messages(10, 1.0))
    limits = Limits((LIMIT, count, energy), ((9.7, (1000.0, 1.0, 1.0)),))
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), limits)[0]
    uses = {(m.stream, m.use) for m in problem.messages if not m.sent}
    assert uses == {(0, (1000.0, 1.0, 1.0)), (1, (1000.0, 1.0, 0.0))}
    assert [t.use for t in problem.traffic] == [(1000.0, 1.0, 1.0)]
    start(problem, SearchSettings()).run(10)


@pytest.mark.parametrize(("aggregation", "newest"), [('"most_recent"', None), ('"current"', Latest(9.9, 1.0))])
def test_the_planner_is_told_of_the_newest_sample_where_it_counts(make_specs, aggregation, newest):
    """Whether it was sent, or dropped; and of the last one sent, which is what receivers show."""
    view, stream = aggregated(make_specs, aggregation)
    stream.note_sent(1, Sent(9.4, 9.4, 1000, 5.0))
    stream.note_generated(1000, Generated(9.9, 1000, 1.0))
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), union())[0]
    assert problem.streams[0].newest == newest
    assert [(m.t_gen, m.scale) for m in problem.messages if m.sent] == [(9.4, 5.0)]


def test_a_frame_that_ends_an_event_is_worth_a_frame_that_begins_one(make_specs):
    """Whatever it shows itself: with `most_recent` the old one is left on the screen."""
    for aggregation, sends in (('"most_recent"', False), ('"current"', True)):
        view, stream = aggregated(make_specs, aggregation)
        stream.note_sent(1, Sent(9.9, 9.9, 1000, 5.0))
        stream.note_generated(1000, Generated(10.0, 1000, 0.1))
        problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0, scale=0.1), (), union())[0]
        assert plan_of(problem).send is sends
