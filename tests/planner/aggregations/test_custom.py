"""Aggregations of the caller's own."""

import sys
from asyncio import CancelledError
from dataclasses import replace

import pytest

from planner import Aggregation, Linear, Message, Problem, ProblemError, SearchSettings, Stream, start
from planner.aggregations import custom
from planner.definition import utility
from planner.tables import tabulate
from tests.planner.models import Coverage, Failing, Newest
from tests.planner.windows import open_messages, optimum, window
from tests.seeds import seeds


def with_model(problem, model):
    return replace(problem, streams=tuple(stream._replace(aggregation=model) for stream in problem.streams))


@pytest.mark.parametrize("mode", ["best", "paper"])
@pytest.mark.parametrize("engine", ["native", "python"])
def test_own_most_recent_is_that_of_the_planner(mode, engine):
    """Written by a caller, it leads to the same decision and the same utility, in either engine."""
    for seed in range(15):
        problem = window(seed, robots=3, horizon=6, goes_on=False)
        searches = [
            start(each, SearchSettings(search=mode, engine=engine)) for each in (problem, with_model(problem, Newest()))
        ]
        for search in searches:
            search.run(300)
        first, second = (search.plan() for search in searches)
        assert first.sends == second.sends
        assert first.utility == pytest.approx(second.utility)


def joint(count, model):
    """A stream of messages from several robots, whose sights overlap."""
    messages = tuple(Message(0, 0.3 * at, 0.3 * at, 0.3 * at, Linear(1.0, 0.1), 1.0, ()) for at in range(count))
    return Problem((Stream(0, model),), messages, count // 2, (), (), -1.0, 10.0, goes_on=False)


def test_stream_with_few_states_is_closed():
    """Its table holds all of them, and either engine searches it."""
    gains = tabulate(joint(6, Coverage())).gains
    assert gains.closed


@pytest.mark.full
@pytest.mark.parametrize("seed", seeds(6, 1))
def test_open_ended_stream_is_searched_by_what_its_plans_are_really_worth(seed):
    """More states than the table holds: the search still finds the best of all subsets, and claims no bound."""
    problem = with_model(window(seed, robots=1, horizon=9, constraints=1, goes_on=False), Coverage(2.0, 0.01))
    tables = tabulate(problem)
    assert not tables.gains.closed
    search = start(problem, SearchSettings(engine="native", max_nodes=2**20))
    search.run(20_000)
    plan = search.plan()
    assert search.done
    assert plan.gap is None
    assert plan.utility == pytest.approx(utility(problem, plan.sends))
    assert plan.utility == pytest.approx(optimum(problem)[0])


def test_open_ended_stream_in_paper_mode():
    """Its nodes carry the true utility."""
    problem = with_model(window(3, robots=1, horizon=10, constraints=1, goes_on=False), Coverage(2.0, 0.01))
    for reduction in ("off", "paper", "exact"):
        search = start(problem, SearchSettings(search="paper", reduction=reduction))
        search.run(400)
        plan = search.plan()
        assert plan.utility == pytest.approx(utility(problem, plan.sends))
        assert plan.opposite is None or plan.lead == pytest.approx(plan.utility - plan.opposite)


def test_states_of_the_table_are_bounded():
    """However many there are, the table stays small."""
    tables = tabulate(with_model(window(1, robots=1, horizon=14, constraints=0), Coverage(3.0, 0.01)))
    assert tables.states.max() <= custom.MAX_STATES + len(tables.message)


@pytest.mark.parametrize("beyond", [True, False])
@pytest.mark.parametrize(
    ("method", "result", "says"),
    [
        ("empty", ValueError("no"), r"Failing\.empty\(\) failed: ValueError: no"),
        ("add", ZeroDivisionError("zero"), r"Failing\.add\(\) failed: ZeroDivisionError: zero"),
        ("add", SystemExit(3), r"Failing\.add\(\) failed: SystemExit: 3"),
        ("add", CancelledError("late"), r"Failing\.add\(\) failed: CancelledError: late"),
        ("value", KeyError("k"), r"Failing\.value\(\) failed: KeyError: 'k'"),
        ("value", float("nan"), r"Failing\.value\(\) returned nan"),
        ("value", float("inf"), r"Failing\.value\(\) returned inf"),
        ("value", "much", r"Failing\.value\(\) failed: ValueError"),
        ("add", [1], r"Failing\.add\(\) returned a list: states must be hashable"),
        ("empty", {}, r"Failing\.empty\(\) returned a dict: states must be hashable"),
    ],
)
def test_failing_model_is_named(method, result, says, beyond):
    """Whatever it does wrong, the error says which method of which stream's aggregation."""
    problem = replace(joint(4, Failing(method, result)), goes_on=beyond)
    with pytest.raises(ProblemError, match=f"stream 0: aggregation {says}"):
        start(problem, SearchSettings())


def test_failing_model_beside_others():
    """The stream is named by its number."""
    problem = window(2, robots=3, horizon=8)
    streams = (Stream(0), Stream(1, Aggregation.SUM), Stream(2, Failing("value", float("nan"))))
    with pytest.raises(ProblemError, match="stream 2"):
        start(replace(problem, streams=streams), SearchSettings())


def test_messages_after_the_end_are_not_added():
    """The model never sees what arrives after the end that it is asked for."""

    class Strict(Newest):
        def value(self, state, t_end):
            assert all(m.t_rcv < t_end for m in state)
            return super().value(state, t_end)

    for seed in range(10):
        problem = with_model(window(seed, robots=2, horizon=8), Strict())
        late = replace(problem, t_end=problem.messages[-3].t_rcv)
        tables = tabulate(late, beyond=True)
        assert tables.gains.facts == pytest.approx(utility(late, []))
        assert tables.gains.everything == pytest.approx(utility(late, open_messages(late)))


class Touchy:
    """A state that cannot be hashed or compared without a fuss."""

    def __init__(self, method):
        self._method = method

    def __hash__(self):
        if self._method == "hash":
            raise ValueError("no hash")
        if self._method == "exit":
            sys.exit("no hash")
        return 1

    def __eq__(self, other):
        if self._method == "exit eq":
            sys.exit("no comparison")
        raise ArithmeticError("no comparison")


@pytest.mark.parametrize("method", ["hash", "exit", "eq", "exit eq"])
def test_states_that_fail_are_a_problem_of_the_stream(method):
    """Whatever their methods raise."""

    class Model:
        def empty(self):
            return Touchy(method)

        def add(self, state, message):  # noqa: ARG002
            return Touchy(method)

        def value(self, state, t_end):  # noqa: ARG002
            return 1.0

    with pytest.raises(ProblemError, match="stream 0"):
        start(joint(4, Model()), SearchSettings())
