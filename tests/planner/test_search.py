"""What every search promises, on both engines and in both modes."""

import dataclasses

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner import Constraint, Linear, Message, Problem, SearchSettings, Stream, start
from planner.constraints import violations
from planner.definition import utility
from tests.planner.windows import objective, objectives, open_messages, optimum, window
from tests.seeds import seeds

CHOICES = [
    SearchSettings(search=search, engine=engine, reduction=reduction)
    for search, reduction in (("best", "off"), ("paper", "off"), ("paper", "paper"), ("paper", "exact"))
    for engine in ("native", "python")
]
windows = st.builds(
    window,
    st.integers(0, 10**6),
    robots=st.integers(1, 5),
    horizon=st.integers(1, 12),
    constraints=st.integers(0, 3),
    grid=st.booleans(),
)


@settings(deadline=None)
@given(windows, st.sampled_from(CHOICES), st.integers(0, 60))
def test_plan_keeps_constraints_and_knows_its_utility(problem, choice, iterations):
    """After any number of iterations the plan fits, its utility is that of the definition, and it decides."""
    search = start(problem, choice)
    search.run(iterations)
    plan = search.plan()
    assert violations(problem, plan.sends) == []
    assert plan.utility == pytest.approx(utility(problem, plan.sends), rel=1e-9, abs=1e-9)
    assert plan.send == (problem.current in plan.sends)
    assert set(plan.sends) <= set(open_messages(problem))
    assert plan.iterations == search.iterations <= iterations
    assert plan.nodes <= choice.max_nodes


@settings(deadline=None)
@given(windows, st.sampled_from(CHOICES))
def test_same_problem_gives_the_same_plan(problem, choice):
    """A search has no memory and no chance in it."""
    plans = []
    for _ in range(2):
        search = start(problem, choice, seed=5)
        search.run(25)
        plans.append(search.plan())
    assert plans[0] == plans[1]


@pytest.mark.parametrize("engine", ["native", "python"])
@pytest.mark.parametrize("seed", seeds(40))
def test_best_mode_finds_the_optimum(seed, engine):
    """Of the last window of a mission the default search proves and returns the best of all subsets."""
    problem = window(seed, robots=1 + seed % 4, horizon=8, constraints=seed % 3, grid=seed % 2 == 0, goes_on=False)
    best, with_current, without = optimum(problem)
    search = start(problem, SearchSettings(engine=engine))
    search.run(2000)
    plan = search.plan()
    assert search.done
    assert plan.utility == pytest.approx(best, rel=1e-8, abs=1e-9)
    opposite = without if plan.send else with_current
    if plan.opposite is not None:
        assert plan.opposite <= opposite + 1e-9 * abs(opposite) + 1e-9
    else:
        assert opposite == float("-inf")


@pytest.mark.parametrize("engine", ["native", "python"])
@pytest.mark.parametrize("seed", seeds(40))
def test_best_mode_finds_the_optimum_of_its_objective(seed, engine):
    """Where the mission goes on, it proves and returns the subset of the best U and what is left behind."""
    problem = window(seed, robots=1 + seed % 4, horizon=8, constraints=seed % 3, grid=seed % 2 == 0)
    best, with_current, without = optimum(problem, objectives)
    search = start(problem, SearchSettings(engine=engine))
    search.run(2000)
    plan = search.plan()
    assert search.done
    assert objective(problem, plan.sends) == pytest.approx(best, rel=1e-8, abs=1e-9)
    if plan.lead is not None:
        assert plan.lead >= 0
        assert plan.lead >= abs(with_current - without) - 1e-9 * abs(best) - 1e-9


@pytest.mark.parametrize("reduction", ["off", "paper", "exact"])
@pytest.mark.parametrize("seed", seeds(15))
def test_paper_mode_never_exceeds_the_optimum(seed, reduction):
    """No plan of paper mode, nor its opposite, is better than the best of all subsets."""
    problem = window(seed, robots=1 + seed % 4, horizon=7, constraints=1 + seed % 2, grid=seed % 2 == 0)
    search = start(problem, SearchSettings(search="paper", reduction=reduction))
    search.run(400)
    plan = search.plan()
    best, with_current, without = optimum(problem)
    assert plan.utility <= best + 1e-9 * abs(best) + 1e-9
    if plan.opposite is not None and reduction != "paper":
        opposite = without if plan.send else with_current
        assert plan.opposite <= opposite + 1e-9 * abs(opposite) + 1e-9


@pytest.mark.parametrize("choice", CHOICES)
def test_zero_iterations_send_nothing(choice):
    """Before the first iteration the answer is to drop, with the utility of the facts."""
    problem = window(4, robots=3, horizon=6)
    search = start(problem, choice)
    assert search.run(0) == 0
    assert search.run(-3) == 0
    plan = search.plan()
    assert (plan.send, plan.sends, plan.opposite, plan.iterations) == (False, (), None, 0)
    assert plan.utility == pytest.approx(utility(problem, []))


@pytest.mark.parametrize("choice", CHOICES)
def test_search_ends_when_its_arena_is_full(choice):
    """A search never holds more nodes than it was given; it is done instead, and its plan stands."""
    problem = window(1, robots=4, horizon=25, constraints=1)
    for nodes in (1, 2, 3, 20, 90):
        search = start(problem, dataclasses.replace(choice, max_nodes=nodes))
        assert search.run(10_000) < 10_000
        assert search.done
        assert search.run(5) == 0
        assert search.plan().nodes <= nodes
        assert violations(problem, search.plan().sends) == []


@pytest.mark.parametrize("choice", CHOICES[:2])
def test_best_mode_decides_the_current_message_however_many_are_open_before_it(choice):
    """Many older messages of unknown fate do not keep one iteration from deciding the current one."""
    older = tuple(Message(0, at * 0.1, at * 0.1, at * 0.1 + 1.0, Linear(1.0, 0.5), 0.01, (1.0,)) for at in range(40))
    current = Message(1, 4.0, 4.0, 5.0, Linear(1.0, 0.1), 5.0, (1.0,))
    streams = (Stream(0), Stream(1))
    problem = Problem(streams, (*older, current), 40, (Constraint("c", 1.0, 1.0),), (), -1.0, 9.0)
    search = start(problem, choice)
    search.run(1)
    plan = search.plan()
    assert plan.send
    assert plan.opposite is not None
    assert plan.opposite < plan.utility


@pytest.mark.parametrize("choice", CHOICES)
def test_message_without_value_is_dropped(choice):
    """What nobody wants is not sent, even when the channel is free: ties are for dropping."""
    worthless = Message(0, 0.0, 0.0, 0.1, Linear(1.0, 1.0), 0.0, (1.0,))
    problem = Problem((Stream(0),), (worthless,), 0, (Constraint("c", 1.0, 5.0),), (), -1.0, 2.0)
    search = start(problem, choice)
    search.run(50)
    assert search.plan().sends == ()


@pytest.mark.parametrize("choice", CHOICES)
def test_valuable_message_is_sent_when_it_fits(choice):
    """A lone message with value is sent when there is room and dropped when there is none."""
    lone = Message(0, 0.0, 0.0, 0.1, Linear(1.0, 1.0), 1.0, (1.0,))
    for limit, sends in ((1.0, (0,)), (0.0, ())):
        problem = Problem((Stream(0),), (lone,), 0, (Constraint("c", 1.0, limit),), (), -1.0, 2.0)
        search = start(problem, choice)
        search.run(50)
        assert search.plan().sends == sends


def test_best_mode_loses_less_than_paper_mode():
    """Summed over windows of ten robots, the default search at 300 iterations beats paper mode at 1,500."""
    total = {"best": 0.0, "paper": 0.0}
    for seed in range(30):
        problem = window(seed, robots=10, horizon=40, constraints=1)
        for search, iterations in (("best", 300), ("paper", 1500)):
            running = start(problem, SearchSettings(search=search))
            running.run(iterations)
            total[search] += running.plan().utility
    assert total["best"] > 1.02 * total["paper"]


def test_two_constraints_hold_at_once():
    """A limit on everybody's messages and one on the own ones bind together."""
    messages = tuple(
        Message(at % 2, at * 0.1, at * 0.1, at * 0.1, Linear(1.0, 0.5), 1.0, (1.0, float(at % 2 == 0)))
        for at in range(10)
    )
    limits = (Constraint("all", 1.0, 3.0), Constraint("own", 1.0, 1.0))
    problem = Problem((Stream(0), Stream(1)), messages, 0, limits, (), -1.0, 2.0, goes_on=False)
    search = start(problem, SearchSettings())
    search.run(300)
    sends = search.plan().sends
    assert len(sends) == 3
    assert sum(at % 2 == 0 for at in sends) == 1
    assert search.plan().utility == pytest.approx(optimum(problem)[0])
