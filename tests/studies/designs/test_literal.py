"""Paper mode with things to the letter of §3: what each form changes, and that nothing else does."""

from dataclasses import replace

import pytest

from planner import Constraint, SearchSettings
from planner.constraints import violations
from planner.definition import utility
from planner.numpy_tables import tabulate_with_numpy
from planner.python_engine.tree import subtree
from planner.tables import tabulate
from studies.central import CentralDecider
from studies.designs.literal import DescendantsAlone, Literal, NewChild
from studies.designs.paper import Paper
from studies.policies import Planned
from studies.workload import MIXED, mission
from tests.planner.windows import window

PAPER = SearchSettings(search="paper")
FLOWN = mission(MIXED, seed=1, seconds=5.0, constraint=Constraint("messages", 2.5, 5.0))


def fly(policy):
    return CentralDecider(FLOWN, 15, forecast=True).fly(policy)


def literal(**what):
    return Literal(FLOWN, PAPER, 60, **what)


@pytest.mark.parametrize("search", [None, Paper])
def test_with_nothing_to_the_letter_it_is_paper_mode(search):
    """On either engine."""
    assert fly(literal(search=search)) == fly(Planned(PAPER, 60))


@pytest.mark.parametrize(
    "what",
    [{"to_the_end": True}, {"whole": True}, {"considered": True, "floor": False}, {"search": NewChild}],
)
def test_every_form_keeps_the_constraints_and_sends_something(what):
    """What it sends is worth something."""
    sends = fly(literal(**what))
    assert violations(FLOWN, sends) == []
    assert utility(FLOWN, sends) > 0


def test_the_score_of_eq_2_is_of_the_whole_mission():
    """U(M) is that of all its messages; what was sent before counts in M_v, however long ago."""
    policy = literal(whole=True)
    decider = CentralDecider(FLOWN, 10)
    for index in range(40):
        if policy(decider.window(index)):
            decider.send(index)
    problem = policy._problem(decider.window(40))
    tables = tabulate_with_numpy(problem)
    assert len(decider.sends) > sum(m.sent for m in decider.window(40).messages)
    assert tables.gains.facts == pytest.approx(utility(FLOWN, decider.sends))
    progress = (FLOWN.messages[40].t_gen - FLOWN.t_start) / (FLOWN.t_end - FLOWN.t_start)
    everything = utility(FLOWN, range(len(FLOWN.messages)))
    assert policy._scale_of(problem, tables)[0] == pytest.approx(progress * everything)


def test_progress_is_that_of_the_next_message_or_of_the_one_considered_with_a_floor_or_without():
    """The floor only matters at the start of a mission."""
    problem = CentralDecider(FLOWN, 5).window(0)
    problem = replace(problem, t_start=problem.messages[0].t_gen)
    tables = tabulate_with_numpy(problem)
    usual = literal()._scale_of(problem, tables)
    assert usual == pytest.approx(tables.scale)
    assert literal(considered=True)._scale_of(problem, tables)[1:] == pytest.approx(usual[:-1])
    unbounded = literal(floor=False)._scale_of(problem, tables)
    assert unbounded[0] == float("inf")
    assert unbounded[1:] == pytest.approx(usual[1:])


def test_a_message_larger_than_a_limit_is_never_sent_by_eq_5():
    """The planner sends it when nothing else is near."""
    large = tuple(m._replace(use=(9.0,), scale=1e6) if m.stream == 9 else m for m in FLOWN.messages)
    flown = replace(FLOWN, messages=large)
    sends = CentralDecider(flown, 15).fly(Literal(flown, PAPER, 60, stretched=False))
    assert {flown.messages[index].stream for index in sends} - {9}
    assert 9 not in {flown.messages[index].stream for index in sends}
    first = next(index for index, m in enumerate(flown.messages) if m.stream == 9)
    alone = CentralDecider(flown, 1).window(first)
    assert Planned(PAPER, 60)(alone)
    assert not Literal(flown, PAPER, 60, stretched=False)(alone)


def test_scoring_a_new_child_scores_the_same_nodes_one_iteration_sooner():
    """Nothing but the root is scored less."""
    for seed in range(5):
        tables = tabulate(window(seed))
        usual, new = Paper(tables, PAPER), NewChild(tables, PAPER)
        usual.run(41)
        new.run(40)
        assert usual._root.visits == new._root.visits + 1
        scored = [{node.level for node in subtree(search._root) if node.visits} for search in (usual, new)]
        assert scored[0] >= scored[1]
        assert all(node.visits >= sum(c.visits for c in node.living_children()) for node in subtree(new._root))


def test_the_mean_of_descendants_leaves_out_the_nodes_own_score():
    """Of a node without descendants there is only its own."""
    search = DescendantsAlone(tabulate(window(3)), replace(PAPER, exploration=0.0))
    search.run(60)
    for node in subtree(search._root)[1:]:
        if node.visits:
            below = [child for child in node.living_children() if child.visits]
            if below and node.level < search._tables.levels:
                assert search._uct(node, 0.0) == pytest.approx(sum(c.sum for c in below) / sum(c.visits for c in below))
            else:
                assert search._uct(node, 0.0) == pytest.approx(node.utility / search._scale[node.level])
