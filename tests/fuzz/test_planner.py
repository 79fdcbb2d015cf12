"""Whatever is asked of the planner, it answers or says what is wrong; it never crashes, and both engines agree."""

import itertools
import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner import (
    Aggregation,
    Constraint,
    Custom,
    Exponential,
    Linear,
    Message,
    Plan,
    PlannerError,
    Polynomial,
    Power,
    Problem,
    ProblemError,
    Receiver,
    SearchSettings,
    Step,
    Stream,
    Table,
    Traffic,
    Video,
    start,
)
from planner.constraints import violations
from planner.definition import utility
from planner.tables import tabulate
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


UTILITIES = (
    Linear(1.0, 1.0),
    Video(),
    Exponential(1.0, 0.5),
    Step(1.0, 0.5),
    Polynomial(1.0, 2.0, 2.0),
    Power(0.5),
    Table(((0.0, 1.0), (1.0, 0.0))),
    Custom(lambda age, features: features["worth"] * (age < 1.0), {"worth": 1.0}),
    Crooked(1.0),
)
AGGREGATIONS = (*Aggregation, Newest(), Coverage(1.0, 0.25))
REDUCTIONS = ("off", "paper", "exact")
LEAST = (0.0, 5e-324, 2e-322, 1e-300, 1.0, 1e100)


def defined(aggregation, utility):
    """Whether streams may be of both: what `current` takes off needs a value at the age 0."""
    return not (aggregation is Aggregation.CURRENT and isinstance(utility, Power))


def mixture(pairs, scales, gaps, *, goes_on=True):
    """A stream for each (aggregation, utility), with messages that follow each other at these `gaps` [s]."""
    messages, now = [], 0.0
    for at, gap in enumerate(gaps):
        stream, scale, now = at % len(pairs), scales[at % len(scales)], now + gap
        messages.append(
            Message(stream, now, now, now + 0.01, pairs[stream][1], scale, (10.0,), sent=at < len(pairs) // 2)
        )
    streams = tuple(Stream(at, aggregation) for at, (aggregation, _) in enumerate(pairs))
    messages.sort(key=lambda m: (m.t_gen, m.stream))
    current = next(at for at, m in enumerate(messages) if not m.sent)
    return Problem(
        streams, tuple(messages), current, (Constraint("c", 1.0, 20.0),), (), 0.0, now + 1.0, goes_on=goes_on
    )


@pytest.mark.full
def test_every_pair_of_aggregations_and_utilities_has_tables():
    """What one stream of a problem is never stands in the way of another."""
    for one, other in itertools.product(AGGREGATIONS, AGGREGATIONS):
        for pair in itertools.combinations(UTILITIES, 2):
            if not (defined(one, pair[0]) and defined(other, pair[1])):
                continue
            problem = mixture([(one, pair[0]), (other, pair[1])], (1.0,), (0.0, 0.1, 0.1, 0.1))
            assert math.isfinite(tabulate(problem, beyond=True).gains.everything)


@given(
    st.lists(
        st.tuples(st.sampled_from(AGGREGATIONS), st.sampled_from(UTILITIES)).filter(lambda pair: defined(*pair)),
        min_size=1,
        max_size=5,
    ),
    st.lists(st.sampled_from(LEAST), min_size=1, max_size=3),
    st.lists(st.sampled_from((0.0, 1e-9, 0.1, 0.5)), min_size=5, max_size=12),
    st.sampled_from([SearchSettings(search="best"), *(SearchSettings("paper", reduction=r) for r in REDUCTIONS)]),
    st.booleans(),
)
def test_any_mixture_of_aggregations_and_utilities_is_searched(pairs, scales, gaps, choice, goes_on):
    """All kinds at once, worth nothing or almost nothing, at the same time or not: both engines plan, and alike."""
    problem = mixture(pairs, scales, gaps, goes_on=goes_on)
    assert isinstance(searched(problem, choice, [40]), Plan)
    check(problem, choice, [40])


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
