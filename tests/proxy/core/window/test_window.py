"""The planning window."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from planner import Receiver, SearchSettings, start
from planner.measures import Energy, Messages, Throughput
from planner.tables import tabulate
from proxy.core.model.limits import Limit, Limits, allowance_of, limits_of, use_of
from proxy.core.model.settings import CoreSettings
from proxy.core.model.transport import broadcast
from proxy.core.model.waiting import Waiting
from proxy.core.protocol.messages import Echo, State
from proxy.core.view.latency import Latency
from proxy.core.view.stream import Generated, Sent
from proxy.core.view.view import SharedView
from proxy.core.window.tuning import TUNING
from proxy.core.window.window import WindowBuilder
from utility_specs import ConstraintSpec, Specs

LIMIT = Limit("throughput", 1.0, 4_000.0, Throughput(4_000.0, 1.0))

BY_RED = """
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
utility = { kind = "python", function = "tests.utility_specs.worths:by_red" }
features.red = { kind = "color_fraction", color = "red", default = 0.5 }
"""
MODEL = '{ python = "tests.utility_specs.models:Everything" }'


def make_view(specs, **settings):
    return SharedView(CoreSettings("r1", "z-r1", **settings), specs)


def add_stream(view, robot, *, period=0.5, scale=1.0, size=1000, until=10.0, key=None):
    """A wanted stream that generated from 5 s to `until`."""
    stream = view.stream(until, robot, key or f"robot/{robot}/camera")
    stream.matching = True
    for count in range(int((until - 5.0) / period) + 1):
        stream.note_generated(count + 1, Generated(5.0 + count * period, size, scale))
    return stream


def sample(t_gen, key="robot/r1/camera", scale=1.0, number=1):
    return Waiting(number, key, 1000, t_gen, scale, 5, markovian=True)


def union(sent=()):
    return Limits((LIMIT,), sent)


@pytest.fixture
def crowd(make_specs):
    """Our stream and those of two others, which the apps here want."""
    view = make_view(make_specs())
    view.set_interest(("robot/**",))
    for robot in ("r1", "r2", "r3"):
        add_stream(view, robot)
    return view


def test_the_window_holds_the_current_message_and_everyones_forecasts(crowd):
    """At most `horizon` messages, in order of generation; the current one is ours, now."""
    problem = WindowBuilder(crowd, 0.0).build(10.0, sample(10.0), (), union())
    current = problem.messages[problem.current]
    assert (current.t_gen, current.t_sent, current.use) == (10.0, 10.0, (1000.0,))
    assert len(problem.streams) == 3
    assert sum(not m.sent for m in problem.messages) <= 61
    assert {m.stream for m in problem.messages} == {0, 1, 2}
    assert problem.t_end > problem.messages[-1].t_gen
    start(problem, SearchSettings()).run(10)


def test_where_each_robot_has_a_part_only_our_own_streams_are_decided(crowd):
    """What we leave nobody else can use; what others sent counts against their parts."""
    part = replace(LIMIT, limit=3000.0)
    limits = Limits((part,), ((9.8, (1000.0,)),), alone=True)
    problem = WindowBuilder(crowd, 0.0).build(10.0, sample(10.0), (), limits)
    assert len(problem.streams) == 1
    assert [limit.limit for limit in problem.constraints] == [3000.0]
    assert [traffic.use for traffic in problem.traffic] == [(1000.0,)]
    assert problem.messages[problem.current].use == (1000.0,)


def test_what_was_sent_is_a_fact(crowd):
    """The last sent message counts for what it is still worth, all recent sends for what they use."""
    for stream in list(crowd.streams()):
        stream.note_sent(1, Sent(9.4, 9.4, 1000, 2.0))
        stream.note_sent(2, Sent(9.7, 9.7, 1000, 2.0))
    sent = ((9.4, (1000.0,)), (9.7, (1000.0,)))
    limits = Limits((LIMIT,), sent, others=sent)
    problem = WindowBuilder(crowd, 0.0).build(10.0, sample(10.0), (), limits)
    facts = [m for m in problem.messages if m.sent]
    assert [(m.t_gen, m.use) for m in facts] == [(9.7, (0.0,))] * 3
    assert sum(t.use[0] for t in problem.traffic) == 4000.0


def test_others_messages_that_would_have_been_announced_are_decisions_only_as_long_as_that_takes(make_specs):
    """The latency, its margin, and what the stream is late by now and then; what was not announced was not sent."""
    view = make_view(make_specs())
    view.set_interest(("robot/**",))
    add_stream(view, "r1")
    late = TUNING.overheard_within + add_stream(view, "r2").schedule.jitter

    def past(now):
        problem = WindowBuilder(view, 0.0).build(now, sample(now), (), union())
        return [(m.stream, m.t_gen) for m in problem.messages if m.t_gen < now]

    assert past(10.5 + 0.9 * late) == [(1, pytest.approx(10.5))]
    assert past(10.5 + 1.1 * late) == []


def test_what_a_lesser_claim_may_have_had_sent_is_no_decision(make_specs):
    """It gives way to us: where all took each other's samples for sent nobody would send any."""
    view = make_view(make_specs())
    view.set_interest(("robot/**",))
    ours, other = add_stream(view, "r1"), add_stream(view, "r2")

    def past(now):
        problem = WindowBuilder(view, 0.0).build(now, sample(now), (), union())
        return [m.t_gen for m in problem.messages if m.t_gen < now and not m.sent]

    view.note_sent(ours, 1, Sent(9.5, 9.5, 1000, 1.0))
    view.note_sent(other, 1, Sent(9.0, 9.0, 1000, 1.0))
    assert past(10.51) == [pytest.approx(10.5)]
    view.note_sent(other, 2, Sent(9.6, 9.6, 1000, 1.0))
    assert past(10.51) == []


def test_times_before_zero_are_times_like_others(make_specs):
    """A clock may show anything: the window is the same, and only later or earlier."""

    def window(zero):
        view = make_view(make_specs())
        view.set_interest(("robot/**",))
        for robot in ("r1", "r2"):
            stream = view.stream(zero + 10.0, robot, f"robot/{robot}/camera")
            for count in range(11):
                stream.note_generated(count + 1, Generated(zero + 5.0 + 0.5 * count, 1000, 1.0))
        view.note_sent(stream, 1, Sent(zero + 9.5, zero + 9.5, 1000, 1.0))
        problem = WindowBuilder(view, zero).build(zero + 10.2, sample(zero + 10.2), (), union())
        times = [t - zero for m in problem.messages for t in (m.t_gen, m.t_sent, m.t_rcv)]
        return [problem.t_start - zero, problem.t_end - zero, *times]

    assert window(-1024.0) == pytest.approx(window(0.0))


def test_who_overhears_takes_what_was_not_heard_in_time_for_not_sent(make_specs):
    """In time is the latency, its margin, and what the stream is late by now and then."""
    group = broadcast("224.0.0.226:7449")
    view = make_view(make_specs(), transport=group)
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", (), ("robot/**",), transport=group))
    add_stream(view, "r1")
    other = add_stream(view, "r2")
    view.set_interest(("robot/**",))
    late = TUNING.overheard_within + other.schedule.jitter

    def past(now):
        problem = WindowBuilder(view, 0.0).build(now, sample(now), (), union())
        return [m.t_gen for m in problem.messages if m.t_gen < now]

    assert past(10.5 + 0.9 * late) == [pytest.approx(10.5)]
    assert past(10.5 + 1.1 * late) == []


def test_a_python_utility_sees_the_features_of_each_sample(make_specs):
    """Our own of the current sample, the newest and the last sent; of others' samples the defaults."""
    view = make_view(make_specs(text=BY_RED))
    view.set_interest(("robot/**",))
    for robot in ("r1", "r2"):
        add_stream(view, robot)
    ours, others = view.streams()
    ours.note_generated(100, Generated(9.9, 1000, 1.0, {"red": 3.0}))
    ours.note_sent(1, Sent(9.7, 9.7, 1000, 1.0, {"red": 2.0}))
    others.note_sent(1, Sent(9.6, 9.6, 1000, 1.0))
    problem = WindowBuilder(view, 0.0).build(10.0, replace(sample(10.0), features={"red": 4.0}), (), union())
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


def aggregated(make_specs, aggregation, **settings):
    """Our stream of samples that combine so, which r2 wants."""
    view = make_view(make_specs(text=BY_RED + f"aggregation = {aggregation}\n"), **settings)
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", (), ("robot/**",)))
    return view, add_stream(view, "r1", period=0.1)


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
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), union())
    found = [(round(m.t_gen, 6), round(m.t_rcv, 6)) for m in problem.messages if m.sent]
    assert found == facts
    assert problem.streams[0].aggregation is stream.information_type.aggregation
    plan_of(problem)


@pytest.mark.parametrize("aggregation", ['"best"', '"sum"', '"once"'])
def test_all_waiting_samples_of_a_stream_are_decided_together(make_specs, aggregation):
    """Each with its own scale; the forecasts of `best` are bounded."""
    view, _ = aggregated(make_specs, aggregation, horizon=100)
    waiting = [sample(9.0 + 0.01 * i, scale=float(i), number=i) for i in range(1, 30)]
    problem = WindowBuilder(view, 0.0).build(10.0, sample(9.0), waiting, union())
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
    problem = WindowBuilder(view, 0.0).build(10.0, sample(9.0), waiting, union())
    opened = [m for m in problem.messages if not m.sent]
    assert [m.scale for m in opened if m.t_gen < 10.0] == [1.0] + [6.0] * TUNING.messages_of_a_model
    assert 1 <= sum(m.t_gen > 10.0 for m in opened) <= TUNING.messages_of_a_model
    assert tabulate(problem).gains.closed


def test_of_once_only_the_robots_without_any_receive(make_specs):
    """One that joins is worth a message, the one that has it is not."""
    view, stream = aggregated(make_specs, '"once"')
    view.note_sent(stream, 1, Sent(9.0, 9.0, 1000, 1.0))
    view.add_peer(9.5, "r3", "z-r3")
    view.heard_state(9.5, State("r3", "z-r3", "enforce", "", (), ("robot/**",)))
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), union())
    assert problem.streams[0].receivers == (Receiver(0.0, 1.0),)
    assert problem.messages[problem.current].use == (2000.0,)


def test_what_others_sent_of_once_still_uses_the_channel(make_specs):
    """Though nobody gains by more of it, so that it is no stream of the problem."""
    view, _ = aggregated(make_specs, '"once"')
    others = add_stream(view, "r2")
    view.note_sent(others, 1, Sent(9.7, 9.7, 1000, 1.0))
    assert view.sent_since(9.0) == [(9.7, (1000, 1))]
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), union())
    assert len(problem.streams) == 1


def test_receivers_of_our_own_stream_are_told_apart_by_latency(crowd):
    """Those of which we know nothing get messages like the others; no message has their number in its scale."""
    for robot, latency in (("r2", 0.02), ("r3", 0.1), ("r4", 0.02)):
        crowd.add_peer(0.0, robot, f"z-{robot}")
        crowd.heard_state(0.0, State(robot, f"z-{robot}", "enforce", "", (), ("robot/**",)))
        crowd.peers[f"z-{robot}"].latency_out = Latency(latency)
    problem = WindowBuilder(crowd, 0.0).build(10.0, sample(10.0), (), union())
    ours, others, _ = problem.streams
    assert ours.receivers == (Receiver(0.0, 2.0), Receiver(pytest.approx(0.08), 1.0))
    assert others.receivers == (Receiver(0.0, 3.0),)
    current = problem.messages[problem.current]
    assert (current.t_rcv, current.scale) == (pytest.approx(10.02), 1.0)
    assert problem.t_end > max(m.t_rcv for m in problem.messages) + 0.08


def test_a_message_arrives_the_later_the_larger_it_is(crowd):
    """The time to a receiver has a part per byte, for what is decided as for what was sent."""
    meet(crowd, Latency(0.02, 1e-5))
    stream = crowd.stream(0.0, "r1", "robot/r1/camera")
    stream.note_sent(1, Sent(9.0, 9.0, 21_000, 1.0))
    problem = WindowBuilder(crowd, 0.0).build(10.0, replace(sample(10.0), size=11_000), (), union())
    (fact,) = [m for m in problem.messages if m.sent and m.stream == 0]
    assert fact.t_rcv == pytest.approx(9.0 + 0.02 + 0.21)
    assert problem.messages[problem.current].t_rcv == pytest.approx(10.0 + 0.02 + 0.11)


def test_what_gets_lost_is_worth_less(crowd):
    """A receiver counts by the part of our samples that it is expected to get."""
    peer = meet(crowd, Latency(0.02))
    for at, sent, received in ((1.0, 0, 0), (2.0, 100, 75)):
        peer.sent = sent
        peer.sent_digest(at)
        peer.heard_echo(at + 0.1, Echo("z-r1", at, at, received, 0.02))
    problem = WindowBuilder(crowd, 0.0).build(10.0, sample(10.0), (), union())
    assert problem.streams[0].receivers == (Receiver(0.0, pytest.approx(0.75)),)


def meet(view, latency):
    """Robot r2 is there, wants everything, and gets our samples after `latency`."""
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", (), ("robot/**",)))
    view.peers["z-r2"].latency_out = latency
    return view.peers["z-r2"]


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
        view.peers[f"z-{number}"].latency_out = Latency(latency)
    stream = add_stream(view, "r1")
    for count, age in enumerate(sorted(ages, reverse=True)):
        stream.note_sent(count + 1, Sent(10.0 - age, 10.0 - age, 1000, 1.0))
    limits = Limits((replace(LIMIT, limit=limit),))
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0, scale=scale), (), limits)
    assert problem.streams[0].receivers == (Receiver(0.0, float(robots)),)
    merged = replace(
        problem,
        streams=tuple(replace(each, receivers=(Receiver(),)) for each in problem.streams),
        messages=tuple(m._replace(scale=m.scale * robots) for m in problem.messages),
    )
    found, expected = plan_of(problem), plan_of(merged)
    assert found.utility == pytest.approx(expected.utility)
    assert found.send == expected.send or abs(expected.lead) <= 1e-6 * expected.utility


def plan_of(problem):
    search = start(problem, SearchSettings())
    search.run(300)
    return search.plan()


def fresh_value(message) -> float:
    return float(message.utility.value(np.zeros(1))[0])


def test_samples_that_wait_are_decided_with_it(crowd):
    """They are ours and generated; only one of them is the current one."""
    add_stream(crowd, "r1", key="robot/x/camera")
    waiting = [sample(9.9, "robot/x/camera", number=2), sample(9.9, "no/such/stream", number=3)]
    problem = WindowBuilder(crowd, 0.0).build(10.0, sample(10.0), waiting, union())
    assert problem.messages[0].t_gen == 9.9
    assert problem.messages[0].t_sent == 10.0
    assert problem.messages[problem.current].t_gen == 10.0


def test_streams_of_low_value_are_thinned_not_time(make_specs):
    """The window reaches four constraint windows ahead whatever the horizon; the best stream stays whole."""
    view = make_view(make_specs(), horizon=20)
    view.set_interest(("robot/**",))
    add_stream(view, "r1", period=0.1, scale=1.0)
    add_stream(view, "r2", period=0.1, scale=50.0)
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), union())
    times = [[m.t_gen for m in problem.messages if m.stream == stream] for stream in (0, 1)]
    assert len(times[0]) + len(times[1]) <= 21
    assert times[1][-1] >= 13.6
    assert len(times[1]) > len(times[0])


def test_one_forecast_of_every_stream_is_kept(make_specs):
    """Of as many as the window has places for."""
    view = make_view(make_specs(), horizon=3)
    view.set_interest(("robot/**",))
    for robot in ("r1", "r2", "r3"):
        add_stream(view, robot)
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), union())
    assert {m.stream for m in problem.messages if not m.sent} == {0, 1, 2}


def chosen(view):
    """Return how long after 9.9 s the streams of other robots in the window generate next."""
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), union())
    ours = problem.messages[problem.current].stream
    return {round(m.t_gen - 9.9, 3) for m in problem.messages if m.stream != ours}


def test_of_too_many_streams_the_best_and_the_next_ones_have_places(make_specs):
    """Half of the places each, beside the stream that is decided."""
    view = make_view(make_specs(), horizon=4)
    view.set_interest(("robot/**",))
    for number in range(8):
        period = 0.25 + 0.01 * number
        stream = view.stream(9.9, f"x{number}", f"robot/x{number}/camera")
        for count in range(8):
            t_gen = 9.9 + (count - 7) * period
            stream.note_generated(count + 1, Generated(t_gen, 1000, 6.0 if number >= 6 else 1.0))
    add_stream(view, "r1", period=2.0, scale=0.1)
    assert chosen(view) == {0.31, 0.32, 0.25, 0.26}


def test_the_stream_that_is_decided_always_has_a_place(make_specs):
    """However little it is worth, and however late it generates."""
    view = make_view(make_specs(), horizon=4)
    view.set_interest(("robot/**",))
    for number in range(8):
        add_stream(view, f"x{number}", scale=2.0)
    add_stream(view, "r1", period=2.0)
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), union())
    assert len(problem.streams) == 5
    assert problem.messages[problem.current].scale == 1.0


def test_digests_are_always_counted_against_the_limit(make_specs):
    """The larger of their share and 100 B/s per robot, but never nearly everything."""
    specs = make_specs(limit="80 kbit/s")
    assert limits_of(specs, 0.02, 1)[0].limit == pytest.approx(9_800.0)
    assert limits_of(specs, 0.02, 5)[0].limit == pytest.approx(9_500.0)
    assert limits_of(make_specs(limit="800 bit/s"), 0.02, 5)[0].limit == pytest.approx(10.0)
    assert allowance_of(specs, 0.05, 2) == 500.0
    assert allowance_of(specs, 0.02, 5) == 500.0


def test_every_copy_counts():
    """In unicast a sample costs a transmission per receiver."""
    assert use_of(100, 3, (LIMIT, LIMIT)) == (300.0, 300.0)


def kinds(*measures):
    """Specs of nothing but constraints."""
    return Specs((), tuple(ConstraintSpec(measure.kind, measure) for measure in measures), "")


def test_digests_count_by_every_measure():
    """So many bytes are at most so many digests of 64 B; of energy only our own digests take."""
    messages, energy = Messages(100, 1.0), Energy(1.0, 1.0, per_byte=1e-3)
    limits = limits_of(kinds(energy, messages), 0.0, 3)
    assert [limit.name for limit in limits] == ["messages", "energy"]
    assert limits[0].limit == pytest.approx(100 - 3 * 100 / (64 * 2))
    assert limits[1].limit == pytest.approx(1.0 - 100 * 1e-3)
    assert [limit.limit for limit in limits_of(kinds(messages), 0.1, 3)] == pytest.approx([90.0])
    assert allowance_of(kinds(messages), 0.06, 3) == pytest.approx(3 * 2 * 64 * 2)
    assert allowance_of(kinds(messages, energy), 0.5, 3) == pytest.approx(3 * 500.0)


def test_others_use_nothing_of_our_energy(make_specs):
    """Their forecasts and what they sent count by the shared measures alone."""
    view = make_view(make_specs())
    view.set_interest(("robot/**",))
    for robot in ("r1", "r2"):
        add_stream(view, robot).note_sent(1, Sent(9.7, 9.7, 1000, 2.0))
    energy = Limit("energy", 1.0, 10.0, Energy(10.0, 1.0, per_byte=1e-3))
    count = Limit("messages", 1.0, 10.0, Messages(10, 1.0))
    limits = Limits((LIMIT, count, energy), ((9.7, (1000.0, 1.0, 1.0)),))
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), limits)
    uses = {(m.stream, m.use) for m in problem.messages if not m.sent}
    assert uses == {(0, (1000.0, 1.0, 1.0)), (1, (1000.0, 1.0, 0.0))}
    assert [t.use for t in problem.traffic] == [(1000.0, 1.0, 1.0)]
    start(problem, SearchSettings()).run(10)


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
    view.set_interest(("robot/**",))
    for robot in ("r1", "r2"):
        stream = view.stream(10.0, robot, f"robot/{robot}/camera")
        stream.matching = True
        for count in range(11):
            features = {"red": 0.01 * count} if robot == "r1" else {}
            stream.note_generated(count + 1, Generated(float(count), 1000, 0.1 * count, features))
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), union())
    ours = [(m.t_gen, m.scale) for m in problem.messages if m.stream == 0][1:3]
    others = [(m.t_gen, m.scale) for m in problem.messages if m.stream == 1][:2]
    assert np.array(ours) == pytest.approx(np.array([(11.0, 1.1), (12.0, 1.4)]))
    assert np.array(others) == pytest.approx(np.array(ours))


def test_others_random_samples_are_expected_from_now_on(make_specs):
    """As nothing was heard of any since, there was none."""
    spec = TRENDING.replace('features = { red = "trend" }', 'schedule = { kind = "poisson", interval = 3 }')
    view = make_view(make_specs(text=spec))
    view.set_interest(("robot/**",))
    for robot in ("r1", "r2"):
        add_stream(view, robot, size=3000)
    problem = WindowBuilder(view, 0.0).build(12.5, sample(12.5), (), union())
    assert [m.t_gen for m in problem.messages if m.stream == 1] == [15.5]


@hypothesis_settings(deadline=None, max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(most=st.integers(1, 90), streams=st.integers(1, 30), queued=st.integers(0, 40))
def test_a_window_that_must_be_small_keeps_what_matters(make_specs, most, streams, queued):
    """The current message, what was sent, and of the samples that wait those worth most."""
    view = make_view(make_specs(), horizon=60)
    view.set_interest(("robot/**",))
    for number in range(streams):
        stream = add_stream(view, "r1", key=f"robot/{number}/camera", scale=1.0 + number)
        stream.note_sent(1, Sent(9.5, 9.5, 1000, 1.0, {}))
    waiting = [sample(9.0 + 0.01 * n, "robot/0/camera", scale=1.0 + n, number=2 + n) for n in range(queued)]
    current = sample(10.0, "robot/0/camera")
    problem, full = WindowBuilder(view, 0.0).within(10.0, current, waiting, union(), most)
    opened = [m for m in problem.messages if not m.sent]
    assert problem.messages[problem.current].t_gen == 10.0
    assert len(opened) - 1 <= max(most, 1) + 1
    kept = {m.scale for m in opened if m.t_gen < 10.0}
    assert kept == {w.scale for w in waiting[queued - len(kept) :]}
    assert len(kept) == min(queued, most // 2)
    assert len([m for m in problem.messages if m.sent]) == len(problem.streams)
    assert len(opened) - 1 <= full


def test_a_window_with_room_enough_is_whole(crowd):
    """Nothing changes while decisions come in time."""
    builder = WindowBuilder(crowd, 0.0)
    waiting = [sample(9.9, number=2)]
    whole = builder.build(10.0, sample(10.0), waiting, union())
    problem, full = builder.within(10.0, sample(10.0), waiting, union(), 61)
    assert problem == whole
    assert full == sum(not m.sent for m in whole.messages) - 1


def offered(make_specs, sizes, *, robots=4, kind=""):
    """Robots with frames of 10 Hz of these sizes, in turn, under a limit of 4 kB/s; the forecasts of each, by size."""
    view = make_view(make_specs(), horizon=400)
    for robot in range(robots):
        stream = view.stream(10.0, f"r{robot + 1}", f"robot/r{robot + 1}/camera")
        stream.matching = True
        for count in range(100):
            stream.note_generated(count + 1, Generated(0.1 * count + 0.02 * robot, sizes[count % len(sizes)], 1.0))
        if kind:
            stream.schedule.assume(0.1, kind)
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), [], union())
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
