"""Aggregations of a caller's own: a network of their states."""

from dataclasses import replace

import pytest

from planner import Receiver
from planner.definition import utility
from studies.oracle import OracleError, optimum, upper_bound
from studies.oracle.aggregations.custom import MAX_NODES, build
from tests.studies.oracle.problems import Annoyed, Hoard, Pairs, of_kind, one_stream


def test_two_arcs_for_each_state_of_each_message():
    """The k-th message finds its stream in one of k states, and the path ends in one of four with what it is worth."""
    part = build(of_kind(one_stream([0.0, 1.0, 2.0], window=0.5, limit=1.0), Annoyed()), 0)
    assert len(part.gain) == 3 + 2 * (1 + 2 + 3) + 4
    assert part.gain[-4:] == pytest.approx([0.0, 2.0 - 0.45, 4.0 - 0.45 * 4, 6.0 - 0.45 * 9])


def test_a_message_too_many_is_not_sent():
    """Messages may be worth less than nothing; two receivers are annoyed twice as much."""
    problem = of_kind(one_stream([0.0, 1.0, 2.0, 3.0], window=0.5, limit=1.0), Annoyed(), Receiver(), Receiver(0.25))
    for solution in (optimum(problem), upper_bound(problem)):
        assert solution.exact
        assert solution.sends.sum() == pytest.approx(2.0)
        assert solution.utility == pytest.approx(2 * (4.0 - 0.45 * 4))


def test_facts_alone_may_cost_something():
    """A mission that cannot but lose has a bound below nothing."""
    problem = of_kind(one_stream([float(at) for at in range(8)], window=0.5, limit=1.0), Annoyed())
    messages = tuple(m._replace(sent=at < 7) for at, m in enumerate(problem.messages))
    solution = upper_bound(replace(problem, messages=messages, current=7))
    assert solution.utility == pytest.approx(14.0 - 0.45 * 49)
    assert solution.sends[7] == pytest.approx(0.0)


def test_a_stream_of_facts_is_a_constant():
    """Where nothing is open, what is known to be sent counts all the same."""
    problem = one_stream([0.0, 1.0, 2.0], window=0.5, limit=1.0)
    first, second, third = problem.messages
    known = replace(problem, messages=(first, second._replace(stream=1, sent=True), third))
    both = of_kind(known, Pairs(), streams=2)
    assert optimum(both).utility == pytest.approx(utility(both, [0, 2]))


@pytest.mark.full
def test_too_many_states_are_refused():
    """Where every set of messages is a state of its own there is no bound; the error names the stream and the model."""
    times = [float(at) for at in range(40)]
    assert optimum(of_kind(one_stream(times[:8], window=0.5, limit=1.0), Hoard())).sends.sum() == 8
    with pytest.raises(OracleError, match=f"stream 0: what Hoard makes of its 40 messages .* {MAX_NODES:,} states"):
        upper_bound(of_kind(one_stream(times, window=0.5, limit=1.0), Hoard()))
