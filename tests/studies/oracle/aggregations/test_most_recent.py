"""The network of a stream: few arcs, every plan a path."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from planner import Aggregation, Linear, Receiver
from planner.definition import utility
from studies.oracle import optimum, upper_bound
from studies.oracle.aggregations.most_recent import build, build_network
from tests.studies.oracle.problems import best_by_trying, of_kind, one_stream, received, small_problems


def arcs_of(problem):
    network = build_network(received(problem))
    return {(int(t), int(h)): float(g) for t, h, g in zip(network.tail, network.head, network.gain, strict=True)}


def test_short_lives_need_few_arcs():
    """A message that is worthless before the next one is received has one arc out: to an empty node."""
    problem = one_stream([float(i) for i in range(50)], window=1.0, limit=1.0)
    short = replace(problem, messages=tuple(m._replace(utility=Linear(1.0, 2.0)) for m in problem.messages))
    arcs = arcs_of(short)
    assert len(arcs) == 3 * 50
    assert all(arcs[i, 50 + i + 1] == 0.25 for i in range(50))
    assert len(arcs_of(problem)) > 5 * 50


def test_an_arc_gains_the_area_between_two_receipts():
    """From message 0 to message 2 the stream lives on message 0."""
    arcs = arcs_of(one_stream([0.0, 1.0, 2.0], window=1.0, limit=1.0))
    assert arcs[0, 2] == 2.0 - 0.125 * 2.0
    assert arcs[0, 1] == 1.0 - 0.125 * 0.5
    assert (3, 4) in arcs


def test_no_arc_passes_a_fact():
    """Every path goes through a message that is known to be sent."""
    problem = one_stream([0.0, 1.0, 2.0], window=1.0, limit=3.0)
    first, second, third = problem.messages
    arcs = arcs_of(replace(problem, messages=(first, second._replace(sent=True), third)))
    assert (0, 2) not in arcs
    assert (4, 5) not in arcs
    assert (0, 1) in arcs
    assert (1, 2) in arcs


def test_each_stream_has_a_source_and_a_sink():
    """Streams that have messages get a path of their own, the others none."""
    problem = one_stream([0.0, 1.0, 2.0], window=1.0, limit=3.0)
    first, second, third = problem.messages
    network = build_network(
        received(replace(problem, streams=problem.streams * 3, messages=(first, second._replace(stream=2), third)))
    )
    assert network.message.tolist() == [0, 2, 1]
    assert network.source.tolist() == [3, 6]
    assert network.sink.tolist() == [5, 7]
    assert network.nodes == 8


def test_a_message_lives_as_long_as_anybody_has_use_for_it():
    """A receiver with a delay gets less of the first second and sees the end of its life as late as all others."""
    problem = one_stream([0.0, 1.0, 3.0], window=1.0, limit=1.0)
    short = replace(problem, messages=tuple(m._replace(utility=Linear(2.0, 1.0)) for m in problem.messages))
    two = arcs_of(of_kind(short, Aggregation.MOST_RECENT, Receiver(), Receiver(0.5, 3.0)))
    assert two[0, 1] == 1.5 + 3.0 * (1.5 + 0.5) / 2
    assert two[0, 3 + 2] == 2.0 + 3.0 * 1.5**2 / 2
    assert (0, 2) not in two


def test_the_end_comes_earlier_for_those_who_wait():
    """What arrives after the end is worth nothing to that receiver, and what it has from before ends with the rest."""
    problem = one_stream([0.0, 1.0], window=1.0, limit=1.0)
    flat = replace(problem, t_end=2.0, messages=tuple(m._replace(utility=Linear(1.0, 1e-9)) for m in problem.messages))
    gains = arcs_of(of_kind(flat, Aggregation.MOST_RECENT, Receiver(), Receiver(1.25, 1.0)))
    assert abs(gains[0, 1] - (1.0 + 0.75)) < 1e-6
    assert abs(gains[1, 2 + 2] - 1.0) < 1e-6


def test_the_column_of_a_message_joins_its_two_nodes():
    """What enters the node of a message leaves by the message's own column, so that it tells what is sent."""
    part = build(received(one_stream([0.0, 1.0], window=1.0, limit=1.0)))
    own = {
        (int(r), float(v))
        for r, c, v in zip(part.balance.row, part.balance.column, part.balance.value, strict=True)
        if c == 1
    }
    assert own == {(1, -1.0), (1 + 5, 1.0)}
    assert part.supply.tolist() == [0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 0.0]


@given(small_problems())
def test_messages_of_current_lose_what_they_show_too_much(problem):
    """The integer optimum is that of trying everything, and no fraction is worth less."""
    current = replace(problem, streams=tuple(s._replace(aggregation=Aggregation.CURRENT) for s in problem.streams))
    best = best_by_trying(current)
    assert utility(current, np.flatnonzero(optimum(current).sends > 0.5).tolist()) == pytest.approx(best, abs=1e-6)
    assert upper_bound(current).bound >= best - 1e-6 * max(1.0, abs(best))
