"""`once`: a path to the first message received."""

from dataclasses import replace

from planner import Aggregation, Receiver
from planner.definition import utility
from studies.oracle import optimum, upper_bound
from studies.oracle.aggregations.once import build
from tests.studies.oracle.problems import of_kind, one_stream, received


def once(times, **facts):
    problem = of_kind(one_stream(times, window=0.5, limit=1.0), Aggregation.ONCE)
    scales = facts.get("scales", [1.0] * len(times))
    known = facts.get("sent", [])
    messages = tuple(
        m._replace(scale=scale, sent=at in known)
        for at, (m, scale) in enumerate(zip(problem.messages, scales, strict=True))
    )
    return replace(problem, messages=messages, current=next(at for at, m in enumerate(messages) if not m.sent))


def test_two_columns_for_each_message():
    """A message is sent first or the path goes on: what comes after the first needs no columns."""
    part = build(received(once([0.0, 1.0, 2.0])))
    assert len(part.gain) == 6
    assert len(part.supply) == 4


def test_waits_for_what_is_worth_more():
    """A poor message is not sent before a rich one, which would then not count; nor is anything after it."""
    assert optimum(once([0.0, 1.0, 2.0], scales=[1.0, 5.0, 2.0])).sends.tolist() == [0.0, 1.0, 0.0]


def test_a_fact_is_the_first_unless_something_comes_before():
    """Before a fact a richer message pays what it is worth more, after it nothing does."""
    after = once([0.0, 1.0], scales=[1.0, 9.0], sent=[0])
    assert optimum(after).sends.tolist() == [1.0, 0.0]
    before = once([0.0, 1.0], scales=[9.0, 1.0], sent=[1])
    assert optimum(before).sends.tolist() == [1.0, 1.0]
    assert upper_bound(before).utility == utility(before, [0])
    poor = once([0.0, 1.0], scales=[0.25, 9.0], sent=[1])
    assert optimum(poor).sends.tolist() == [0.0, 1.0]


def test_streams_have_paths_of_their_own():
    """Each stream has its own first message, and each receiver adds its part."""
    problem = once([0.0, 1.0, 2.0, 3.0])
    messages = tuple(m._replace(stream=at % 2) for at, m in enumerate(problem.messages))
    two = of_kind(replace(problem, messages=messages), Aggregation.ONCE, Receiver(), Receiver(0.5, 2.0), streams=2)
    solution = optimum(two)
    assert solution.sends.tolist() == [1.0, 1.0, 0.0, 0.0]
    assert abs(solution.utility - utility(two, [0, 1, 2, 3])) < 1e-9
