"""The paper's search, step by step."""

import math

import pytest

from planner import Constraint, Linear, Message, Problem, SearchSettings, Stream
from planner.python_engine.paper import PaperSearch
from planner.tables import tabulate

FLAT = Linear(1.0, 1e-9)
DROP, SEND = 0, 1


def problem(*scales, current=0, limit=9.0, length=1.5, streams=None):
    """Messages at t = 0, 1, 2, … worth about their scale per second until t = 10."""
    streams = streams or tuple(range(len(scales)))
    messages = tuple(
        Message(stream, float(at), float(at), float(at), FLAT, scale, (1.0,))
        for at, (scale, stream) in enumerate(zip(scales, streams, strict=True))
    )
    return Problem(
        tuple(Stream(robot) for robot in range(max(streams) + 1)),
        messages,
        current,
        (Constraint("c", length, limit),),
        (),
        0.0,
        10.0,
    )


def grown(window, iterations, **settings):
    search = PaperSearch(tabulate(window), SearchSettings(search="paper", **settings))
    search.run(iterations)
    return search


def visits(search):
    """Visits by path from the root, like {"": 3, "d": 1, "s": 1}."""
    rows, paths, found = search.tree(), {-1: ""}, {}
    for index, (parent, level, decision, count, _, _) in enumerate(rows):
        if parent == -2:
            continue
        paths[index] = paths[parent] + ("ds"[decision] if level else "")
        found[paths[index]] = count
    return found


def test_first_iterations():
    """The root is scored first, then its drop child, then its send child; each iteration expands one node."""
    assert visits(grown(problem(1.0, 1.0), 0)) == {"": 0}
    assert visits(grown(problem(1.0, 1.0), 1)) == {"": 1, "d": 0, "s": 0}
    assert visits(grown(problem(1.0, 1.0), 2)) == {"": 2, "d": 1, "s": 0, "dd": 0, "ds": 0}
    third = {"": 3, "d": 1, "s": 1, "dd": 0, "ds": 0, "sd": 0, "ss": 0}
    assert visits(grown(problem(1.0, 1.0), 3)) == third
    assert visits(grown(problem(1.0, 1.0), 4)) == third | {"": 4, "s": 2, "sd": 1}


def test_scores_are_those_of_equation_2():
    """A node adds U / (ψ·U(M)) per visit, with at least 0.01 s of progress, to itself and its ancestors."""
    rows = grown(problem(3.0, 1.0), 3).tree()
    everything = 3.0 * 10 + 1.0 * 9
    send = 3.0 * 10 / (1.0 / 10.0 * everything)
    assert rows[2][4] == pytest.approx(send)
    assert rows[1][4] == 0.0
    assert rows[0][4] == pytest.approx(send)
    root = grown(problem(3.0, 1.0, streams=(0, 1)), 1).tree()[0]
    assert root[4] == 0.0


def test_selection_follows_equation_3():
    """Once both children were visited the greater UCT is followed."""
    search = grown(problem(1.0, 1.0), 3)
    rows = search.tree()
    uct = [row[4] / row[3] + 0.35 * math.sqrt(math.log(3) / row[3]) for row in rows[1:3]]
    assert uct[SEND] > uct[DROP]
    search.run(1)
    assert search.tree()[2][3] == 2


def test_send_that_breaks_a_constraint_is_no_child():
    """With room for one message per window the second cannot follow the first."""
    found = visits(grown(problem(1.0, 1.0, limit=1.0), 30))
    assert "ss" not in found
    assert {"sd", "ds", "dd"} <= set(found)


def test_answer_is_the_most_visited_path():
    """The plan follows the visits, and tells what the opposite would have given."""
    plan = grown(problem(3.0, 1.0, limit=1.0), 60, exploration=20.0).plan()
    assert plan.send
    assert plan.sends == (0,)
    assert plan.utility == pytest.approx(30.0)
    assert plan.opposite == pytest.approx(9.0)


def test_current_that_the_tree_does_not_reach_is_dropped():
    """A tree that stays above the current message's level answers to drop it."""
    window = problem(*[1.0] * 12, current=11)
    plan = grown(window, 5).plan()
    assert not plan.send
    assert plan.opposite is None


def test_nothing_of_value_scores_zero():
    """A window whose messages are all worthless is searched without a division by zero."""
    search = grown(problem(0.0, 0.0), 20)
    assert all(row[4] == 0.0 for row in search.tree())
    assert not search.plan().send


def test_reduction_merges_tantamount_nodes():
    """Once the last message of the stream is the same only the better of two nodes lives."""
    one_stream = problem(1.0, 1.0, 1.0, limit=9.0, streams=(0, 0, 0))
    alive = set(visits(grown(one_stream, 200, exploration=20.0, reduction="paper")))
    assert len(set(visits(grown(one_stream, 200, exploration=20.0)))) == 15
    assert {path for path in alive if len(path) == 3} <= {"ddd", "dds", "sds", "ssd", "dsd", "sdd", "sss", "dss"}
    assert len([path for path in alive if len(path) == 3]) == 4


def test_exact_reduction_keeps_nodes_apart_whose_windows_differ():
    """With a window that still holds the first message, sending it is not tantamount to dropping it."""
    one_stream = problem(1.0, 1.0, 1.0, limit=2.0, length=2.5, streams=(0, 0, 0))
    level_two = {path for path in visits(grown(one_stream, 3, reduction="exact")) if len(path) == 2}
    assert {"ds", "ss"} <= level_two
    merged = {path for path in visits(grown(one_stream, 3, reduction="paper")) if len(path) == 2}
    assert not {"ds", "ss"} <= merged
