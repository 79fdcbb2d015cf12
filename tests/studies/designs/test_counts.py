"""Whole trees are counted as the search grows them, and as the paper does where its formula is right."""

from collections import Counter
from itertools import product

import pytest

from planner import Constraint, Linear, Message, Problem, SearchSettings, Stream
from planner.native_engine import NativeSearch
from planner.python_engine.tree import CUT
from planner.tables import tabulate
from studies.designs.counts import Regular, count

TEAMS = [Regular(3, 3, 1), Regular(3, 4, 2), Regular(2, 5, 2)]


def grown(team, levels, reduction):
    """Count the nodes alive by level once the search has grown the whole tree."""
    messages = tuple(
        Message(i % team.streams, float(i), float(i), i + 0.1, Linear(1.0, 0.2), 1.0, (1.0,)) for i in range(levels + 9)
    )
    streams = tuple(Stream(robot) for robot in range(team.streams))
    limit = Constraint("messages", team.held - 0.5, float(team.most))
    problem = Problem(streams, messages, 0, (limit,), (), 0.0, levels + 10.0)
    search = NativeSearch(tabulate(problem), SearchSettings("paper", reduction=reduction, exploration=1e3))
    search.run(20_000)
    return Counter(row[1] for row in search.tree() if row[0] != CUT)


@pytest.mark.parametrize("team", TEAMS)
def test_the_search_grows_as_many_nodes(team):
    """Without Eq. 7 all plans that keep the constraint; with it no more than there are states: it cuts barren nodes."""
    levels = 7
    off, exact, paper = (grown(team, levels, reduction) for reduction in ("off", "exact", "paper"))
    for nodes in count(team, levels):
        assert off[nodes.level] == nodes.allowed
        assert nodes.both // 2 < paper[nodes.level] <= nodes.both
        assert nodes.exact // 2 < exact[nodes.level] <= nodes.exact


@pytest.mark.parametrize("team", TEAMS)
def test_states_are_those_of_all_plans_that_keep_the_constraint(team):
    """By the definition, plan by plan."""
    for nodes in count(team, 10):
        plans = [plan for plan in product((0, 1), repeat=nodes.level) if lawful(plan, team)]
        assert nodes.allowed == len(plans)
        assert nodes.both == len({last(plan, team) for plan in plans})
        assert nodes.exact == len({(last(plan, team), plan[1 - team.held :]) for plan in plans})


def lawful(plan, team):
    return all(sum(plan[i : i + team.held]) <= team.most for i in range(len(plan)))


def last(plan, team):
    sent = [i for i, decision in enumerate(plan) if decision]
    return tuple(max((i for i in sent if i % team.streams == s), default=-1) for s in range(team.streams))


@pytest.mark.parametrize("team", [Regular(10, 5, 2), Regular(10, 10, 4), Regular(4, 6, 3)])
def test_the_papers_count_is_exact_around_a_window_and_too_high_beyond(team):
    """At the levels k − 1, k and k + 1."""
    for nodes in count(team, 16):
        if nodes.level < team.held - 1:
            assert nodes.claimed is None
        elif nodes.level <= team.held + 1:
            assert nodes.claimed == nodes.allowed
        else:
            assert nodes.claimed > nodes.allowed


def test_growth_is_far_below_two():
    """1.39 a level for ten messages in a window of which two are sent."""
    known = list(count(Regular(10, 10, 2), 30))
    assert (known[-1].allowed / known[-11].allowed) ** 0.1 == pytest.approx(1.39, abs=0.005)


def test_states_are_those_of_eq_8_with_one_more_a_stream():
    """As printed there is none before each stream has generated twice, although there are plans."""
    known = list(count(Regular(3, 20, 19), 12))
    for nodes in known:
        assert nodes.both == nodes.states
        assert nodes.printed < nodes.states
    assert [nodes.printed for nodes in known[:3]] == [0, 0, 1]
    assert known[-1].printed == 4**3
    assert known[-1].states == 5**3
