"""Whatever is asked of the planner, it answers or says what is wrong; it never crashes, and both engines agree."""

import math
from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from planner import (
    Aggregation,
    Constraint,
    Linear,
    Message,
    PlannerError,
    Problem,
    ProblemError,
    Receiver,
    SearchSettings,
    Stream,
    Traffic,
    Video,
    start,
)
from planner.constraints import violations
from planner.definition import utility
from tests.planner.models import Coverage, Failing, Newest
from tests.planner.windows import window

ODD = st.sampled_from((math.nan, math.inf, -math.inf, -1.0, -0.0, 0.0, 5e-324, 1e-9, 1e9, 1e154, 1e308))
NUMBERS = st.one_of(ODD, st.floats(), st.floats(0.0, 10.0))


class Crooked:
    """A utility that returns what it should not."""

    def __init__(self, result):
        self._result = result

    def value(self, age):
        return self._of(age)

    def integral(self, start, end):
        return self._of(end - start)

    def _of(self, like):
        if isinstance(self._result, Exception):
            raise self._result
        return like * self._result


MODELS = st.sampled_from(
    (
        *Aggregation,
        Newest(),
        Coverage(1.0, 0.05),
        Failing("add", RuntimeError("fails")),
        Failing("value", math.nan),
        Failing("value", 1e308),
        Failing("empty", []),
    )
)


@st.composite
def utilities(draw):
    """Functions with any parameters that they accept."""
    try:
        if draw(st.booleans()):
            return Linear(draw(NUMBERS), draw(NUMBERS))
        return Video(draw(NUMBERS), draw(NUMBERS))
    except ProblemError:
        return Linear(1.0, 0.5)


@st.composite
def messages(draw, streams, constraints):
    """Any messages, most of them with times in order."""
    t_gen = draw(NUMBERS)
    delays = (draw(st.floats(0.0, 1.0)), draw(st.floats(0.0, 1.0))) if draw(st.booleans()) else (draw(NUMBERS),) * 2
    uses = st.tuples(*[NUMBERS] * constraints)
    return Message(
        stream=draw(st.integers(-1, streams)),
        t_gen=t_gen,
        t_sent=t_gen + delays[0],
        t_rcv=t_gen + delays[0] + delays[1],
        utility=draw(utilities()),
        scale=draw(NUMBERS),
        use=draw(uses),
        sent=draw(st.booleans()),
    )


@st.composite
def any_problem(draw):
    """Problems that mostly mean nothing."""
    count, limits = draw(st.integers(0, 4)), draw(st.integers(0, 3))
    receivers = st.lists(st.builds(Receiver, NUMBERS, NUMBERS), max_size=2).map(tuple)
    streams = tuple(Stream(draw(st.integers(-1, 3)), draw(MODELS), draw(receivers)) for _ in range(count))
    listed = draw(st.lists(messages(count, limits), max_size=6))
    listed.sort(key=lambda m: m.t_gen)
    return Problem(
        streams,
        tuple(listed),
        draw(st.integers(-1, 6)),
        tuple(Constraint(f"c{k}", draw(NUMBERS), draw(NUMBERS)) for k in range(limits)),
        tuple(Traffic(draw(NUMBERS), draw(st.tuples(*[NUMBERS] * limits))) for _ in range(draw(st.integers(0, 2)))),
        draw(NUMBERS),
        draw(NUMBERS),
        goes_on=draw(st.booleans()),
    )


@st.composite
def spoilt_window(draw):
    """Windows of which one number was replaced by another."""
    seed, limits = draw(st.integers(0, 10_000)), draw(st.integers(0, 3))
    kinds = tuple(draw(st.lists(MODELS, min_size=2, max_size=4)))
    problem = window(seed, robots=1 + seed % 4, horizon=draw(st.integers(1, 9)), constraints=limits, aggregations=kinds)
    at = draw(st.integers(0, len(problem.messages) - 1))
    message = problem.messages[at]
    field = draw(st.sampled_from(("t_gen", "t_sent", "t_rcv", "scale", "use", "utility", "nothing")))
    if field in ("t_gen", "t_sent", "t_rcv", "scale"):
        message = message._replace(**{field: draw(NUMBERS)})
    elif field == "use":
        message = message._replace(use=draw(st.lists(NUMBERS, max_size=limits + 1)))
    elif field == "utility":
        message = message._replace(
            utility=Crooked(draw(st.sampled_from((math.nan, math.inf, -1.0, 1e308, "much", ValueError("no")))))
        )
    return replace(problem, messages=(*problem.messages[:at], message, *problem.messages[at + 1 :]))


@st.composite
def settings(draw):
    """Any settings, most of them possible."""
    return SearchSettings(
        search=draw(st.sampled_from(("best", "paper", "worst"))),
        reduction=draw(st.sampled_from(("off", "paper", "exact", ""))),
        exploration=draw(st.one_of(st.just(0.35), NUMBERS)),
        max_nodes=draw(st.sampled_from((65_536, 300, 17, 2, 1, 0, -5, 2**30))),
    )


@given(any_problem(), settings())
def test_nonsense_is_refused_or_answered(problem, choice):
    """Whatever the numbers are."""
    check(problem, choice, [30])


@given(spoilt_window(), settings(), st.lists(st.integers(-3, 60), max_size=3))
def test_windows_with_a_fault_are_refused_or_answered(problem, choice, runs):
    """Whichever number is wrong."""
    check(problem, choice, runs)


@given(spoilt_window(), st.sampled_from(("best", "paper")), st.sampled_from((0, 1, 150)))
def test_windows_with_a_fault_are_searched(problem, mode, iterations):
    """Where the settings are right, so that most windows are searched."""
    check(problem, SearchSettings(search=mode), [iterations])


def check(problem, choice, runs):
    """A PlannerError, or the same plan of either engine: finite, within every constraint, of the utility it names."""
    native, python = (searched(problem, replace(choice, engine=engine), runs) for engine in ("native", "python"))
    if isinstance(native, PlannerError):
        assert str(native)
        assert str(native) == str(python)
        return
    assert native == python
    assert math.isfinite(native.utility)
    assert violations(problem, native.sends) == []
    assert native.send == (problem.current in native.sends)
    assert native.gap is None or native.gap >= 0
    worth = utility(problem, native.sends)
    most = max(abs(worth), abs(utility(problem, range(len(problem.messages)))), 1e-9)
    assert abs(native.utility - worth) <= 0.05 * most


def searched(problem, choice, runs):
    """The plan after these runs, or the error with which the problem or the settings are refused."""
    try:
        search = start(problem, choice)
    except PlannerError as error:
        return error
    for iterations in runs:
        assert 0 <= search.run(iterations) <= max(iterations, 0)
    return search.plan()
