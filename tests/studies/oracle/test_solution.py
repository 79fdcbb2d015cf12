"""The oracle against all subsets, and what it says of special windows."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from planner import Constraint, Problem, ProblemError, Stream, Traffic
from planner.constraints import violations
from planner.definition import utility
from studies.central import CentralDecider
from studies.oracle import optimum, upper_bound
from studies.policies import whenever_it_fits
from tests.planner.windows import optimum as greatest
from tests.seeds import seeds
from tests.studies.oracle.problems import KINDS, best_by_trying, mixed_mission, mixed_window, one_stream, small_problems


def chosen(problem: Problem, sends: np.ndarray) -> list[int]:
    return [i for i, message in enumerate(problem.messages) if sends[i] > 0 and not message.sent]


@given(small_problems())
def test_optimum_is_the_best_of_all_subsets(problem):
    """The integer programme finds what trying every subset finds, with a plan that breaks no constraint."""
    best = best_by_trying(problem)
    solution = optimum(problem)
    assert solution.exact
    assert solution.utility == pytest.approx(best, rel=1e-6, abs=1e-6)
    assert violations(problem, chosen(problem, solution.sends)) == []


@given(small_problems())
def test_upper_bound_is_one(problem):
    """No subset is worth more than the linear programme; where its plan is whole it is the optimum."""
    best = best_by_trying(problem)
    solution = upper_bound(problem)
    assert solution.utility >= best - 1e-6 * max(1.0, best)
    assert all(solution.sends[i] == 1.0 for i, message in enumerate(problem.messages) if message.sent)
    if solution.exact:
        assert solution.utility == pytest.approx(best, rel=1e-6, abs=1e-6)


@pytest.mark.full
@pytest.mark.parametrize("block", seeds(8, 1))
def test_all_kinds_at_once(block):
    """With all aggregations, several receivers and up to three constraints the optimum is that of all subsets.

    The bound is at least that, and the same where it is a plan.
    """
    for seed in range(40 * block, 40 * block + 40):
        problem = mixed_window(seed)
        best = greatest(problem)[0]
        rounding = 1e-5 * max(1.0, abs(best))
        solution, bound = optimum(problem), upper_bound(problem)
        assert solution.exact, seed
        assert solution.utility == pytest.approx(best, rel=1e-5, abs=1e-5), seed
        assert solution.bound == pytest.approx(best, rel=1e-5, abs=1e-5), seed
        assert violations(problem, chosen(problem, solution.sends)) == [], seed
        assert bound.utility >= best - rounding, seed
        assert not bound.exact or bound.utility <= best + rounding, seed


@pytest.mark.full
@pytest.mark.parametrize("seed", range(2))
def test_a_mission_of_all_kinds(seed):
    """A mission of all aggregations, two constraints and messages that exceed one of them: bound, optimum, a policy."""
    problem = mixed_mission(seed)
    bound, best = upper_bound(problem), optimum(problem, time_limit=60.0)
    simple = CentralDecider(problem, 30).fly(whenever_it_fits)
    assert violations(problem, chosen(problem, best.sends)) == []
    assert bound.bound >= best.utility * (1 - 1e-6)
    assert best.bound >= best.utility * (1 - 1e-6)
    assert best.utility > 1.02 * utility(problem, simple)


def test_everything_is_sent_without_constraints():
    """Where nothing limits, all messages are sent and the bound is the utility of all."""
    limited = one_stream([0.0, 1.0, 2.0], window=1.0, limit=1.0)
    free = replace(limited, constraints=(), messages=tuple(m._replace(use=()) for m in limited.messages))
    for solution in (upper_bound(free), optimum(free)):
        assert solution.exact
        assert solution.sends.tolist() == [1.0, 1.0, 1.0]
        assert solution.utility == pytest.approx(utility(free, [0, 1, 2]))


def test_window_is_closed():
    """Two messages exactly one window apart share it."""
    assert optimum(one_stream([0.0, 1.0, 2.0], window=1.0, limit=1.0)).sends.sum() == 2
    assert optimum(one_stream([0.0, 1.0, 2.0], window=0.99, limit=1.0)).sends.sum() == 3


def test_oversized_message_needs_a_stretched_window_for_itself():
    """A message of three limits is sent only when nothing was sent in three windows before it."""
    problem = one_stream([0.0, 2.0, 4.0], window=1.0, limit=1.0, sizes=[1.0, 1.0, 3.0])
    last_matters = replace(
        problem, messages=(*problem.messages[:2], problem.messages[2]._replace(scale=100.0)), t_end=6.0
    )
    assert optimum(problem).sends.tolist() == [1.0, 1.0, 0.0]
    assert optimum(last_matters).sends.tolist() == [1.0, 0.0, 1.0]


def test_traffic_takes_its_part_of_the_window():
    """What others put on the air leaves less for messages."""
    problem = one_stream([0.0, 1.0, 2.0], window=0.5, limit=2.0)
    busy = replace(problem, traffic=(Traffic(0.75, (2.0,)),))
    assert optimum(busy).sends.tolist() == [1.0, 0.0, 1.0]


def test_facts_are_counted_and_worth_something():
    """A message known to be sent uses its window and gains its utility."""
    problem = one_stream([0.0, 0.25, 2.0], window=0.5, limit=1.0)
    known = replace(problem, current=1, messages=(problem.messages[0]._replace(sent=True), *problem.messages[1:]))
    solution = optimum(known)
    assert solution.sends.tolist() == [1.0, 0.0, 1.0]
    assert solution.utility == pytest.approx(utility(problem, [0, 2]))


def test_nothing_may_be_sent_under_a_limit_of_zero():
    """A limit of zero bans what uses the constraint and nothing else."""
    problem = one_stream([0.0, 1.0], window=0.5, limit=0.0, sizes=[1.0, 0.0])
    assert optimum(problem).sends.tolist() == [0.0, 1.0]
    assert upper_bound(problem).sends.tolist() == [0.0, 1.0]


def test_all_constraints_hold_at_once():
    """The tighter of two constraints decides, wherever it is tighter."""
    problem = one_stream([0.0, 1.0, 2.0, 3.0], window=0.5, limit=1.0)
    pair = (*problem.constraints, Constraint("bytes", 1.5, 10.0))
    sizes = (5.0, 5.0, 8.0, 1.0)
    messages = tuple(m._replace(use=(1.0, size)) for m, size in zip(problem.messages, sizes, strict=True))
    solution = optimum(replace(problem, constraints=pair, messages=messages))
    assert solution.sends.tolist() == [1.0, 1.0, 0.0, 1.0]


def test_fractions_are_told_from_plans():
    """Where sending halves beats any plan, the bound says that it is no plan; the optimum is below."""
    triangle = one_stream([0.0, 0.25, 0.5], window=0.5, limit=3.0, sizes=[2.0, 2.0, 2.0])
    messages = tuple(m._replace(stream=i) for i, m in enumerate(triangle.messages))
    problem = replace(triangle, streams=triangle.streams * 3, messages=messages)
    bound, best = upper_bound(problem), optimum(problem)
    assert not bound.exact
    assert bound.utility > best.utility * 1.1
    assert bound.sends.sum() == pytest.approx(1.5)
    assert best.bound == pytest.approx(best.utility)


@pytest.mark.parametrize("kind", KINDS, ids=str)
def test_what_nobody_receives_is_worth_nothing(kind):
    """A stream without receivers gains nothing and leaves the channel to the others, whatever its aggregation."""
    problem = one_stream([0.0, 0.25, 2.0, 2.25], window=0.5, limit=1.0)
    messages = tuple(m._replace(stream=at % 2, scale=9.0 - 8.0 * (at % 2)) for at, m in enumerate(problem.messages))
    deaf = replace(problem, streams=(Stream(0, kind, ()), Stream(1)), messages=messages)
    for solution in (optimum(deaf), upper_bound(deaf)):
        assert solution.sends[[1, 3]].tolist() == [1.0, 1.0]
        assert solution.utility == pytest.approx(utility(deaf, [1, 3]))


def test_a_problem_without_meaning_is_refused():
    """The planner's own checks come first."""
    problem = one_stream([0.0, 1.0], window=0.5, limit=1.0)
    with pytest.raises(ProblemError, match="t_start"):
        upper_bound(replace(problem, t_end=-1.0))
