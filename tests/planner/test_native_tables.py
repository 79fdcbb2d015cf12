"""Tables made in C++ say what those made with NumPy say."""

import dataclasses
import itertools
from collections import defaultdict
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from planner import (
    Aggregation,
    Constraint,
    Exponential,
    Latest,
    Linear,
    Message,
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
from planner.definition import utility
from planner.native_tables import NativeTables
from planner.numpy_tables import NumpyTables, tabulate_with_numpy
from planner.tables import tabulate
from tests.planner.models import Newest
from tests.planner.utility.kinds import utilities
from tests.planner.windows import crowded, window

CLOSE = 1e-12
"""By how much numbers may differ, as a part of the largest of their table."""

AMOUNTS = st.sampled_from((0.0, 0.5, 1.0, 2.0, 7.0)) | st.floats(0.01, 10.0)
GAPS = st.sampled_from((0.0, 1e-9, 0.1, 0.5)) | st.floats(0.0, 2.0)
"""Round numbers, so that times are equal and windows just full; and any."""

NEWEST = st.none() | st.builds(Latest, st.sampled_from((-3.0, 0.0, 1.0)) | st.floats(-5.0, 30.0), AMOUNTS)

ENDLESS = st.sampled_from(
    (Step(1.0, 1e9), Table(((0.0, 1.0),)), Power(0.5), Linear(1.0, 1e-9), Exponential(1.0, 1e9), Video(0.1, 1e6))
)
"""What is worth something for ever, or nearly so."""


@st.composite
def problems(draw):
    """Windows of streams of any standard kinds side by side, with facts, receivers, traffic and limits."""
    count, limits = draw(st.integers(1, 6)), draw(st.integers(0, 3))
    receivers = st.lists(st.builds(Receiver, GAPS, AMOUNTS), max_size=3).map(tuple)
    streams = tuple(
        Stream(draw(st.integers(0, 2)), draw(st.sampled_from(Aggregation)), draw(receivers), draw(NEWEST))
        for _ in range(count)
    )
    of_stream = [draw(utilities | ENDLESS) for _ in range(count)]
    latency = [draw(GAPS) for _ in range(count)]
    uses = st.tuples(*[AMOUNTS] * limits)
    messages, now = [], draw(st.sampled_from((0.0, -3.0, 100.0)))
    for _ in range(draw(st.integers(1, 14))):
        now += draw(GAPS)
        stream, sent = draw(st.integers(0, count - 1)), draw(st.booleans())
        late = draw(GAPS) if sent else 0.0
        function = draw(utilities) if draw(st.booleans()) else of_stream[stream]
        if streams[stream].aggregation is Aggregation.CURRENT and isinstance(function, Power):
            function = Linear(1.0, 0.5)
        messages.append(
            Message(
                stream, now, now + late / 2, now + late + latency[stream], function, draw(AMOUNTS), draw(uses), sent
            )
        )
    messages.sort(key=lambda m: (m.t_gen, streams[m.stream].robot, m.stream))
    if all(m.sent for m in messages):
        messages[-1] = messages[-1]._replace(t_sent=messages[-1].t_gen, sent=False)
    opened = [at for at, m in enumerate(messages) if not m.sent]
    messages = _in_order(messages)
    return Problem(
        streams,
        tuple(messages),
        draw(st.sampled_from(opened)),
        tuple(Constraint(f"c{k}", draw(st.sampled_from((0.1, 0.5, 1.0, 3.0))), draw(AMOUNTS)) for k in range(limits)),
        tuple(Traffic(now - draw(GAPS), draw(uses)) for _ in range(draw(st.integers(0, 4)))),
        messages[0].t_gen - 1.0,
        messages[-1].t_gen + draw(st.sampled_from((1e-3, 0.1, 1.0)) | st.floats(0.01, 20.0)),
        goes_on=draw(st.booleans()),
    )


def _in_order(messages):
    """Open messages of one stream are received in the order in which they are sent."""
    received, ordered = {}, []
    for m in messages:
        t_rcv = m.t_rcv if m.sent else max(m.t_rcv, received.get(m.stream, m.t_rcv))
        received |= {} if m.sent else {m.stream: t_rcv}
        ordered.append(m._replace(t_rcv=t_rcv))
    return ordered


def assert_alike(problem, *, beyond):
    """Both tables have the same levels, states and checks, and numbers that hardly differ."""
    native, numpy = tabulate(problem, beyond=beyond), tabulate_with_numpy(problem, beyond=beyond)
    assert isinstance(native, NativeTables)
    assert native.current == numpy.current
    assert native.message == numpy.message
    assert native.states.tolist() == numpy.states.tolist()
    assert list(native.constraint) == list(numpy.constraint)
    assert (native.exact, native.closed, native.levels, native.streams) == (
        numpy.exact,
        numpy.closed,
        numpy.levels,
        numpy.streams,
    )
    for name in ("stream", "start", "after", "markovian"):
        assert getattr(native.gains, name).tolist() == getattr(numpy.gains, name).tolist(), name
    for name in ("start", "of", "first", "held", "never"):
        assert getattr(native.checks, name).tolist() == getattr(numpy.checks, name).tolist(), name
    for name in ("of", "first", "last"):
        assert getattr(native.checks.rows, name).tolist() == getattr(numpy.checks.rows, name).tolist(), name
    for name in ("use", "share", "room"):
        assert_close(getattr(native.checks, name), getattr(numpy.checks, name), name)
    assert_close(native.checks.rows.capacity, numpy.checks.rows.capacity, "capacity")
    largest = np.abs(np.concatenate((numpy.gains.gain, numpy.gains.aim, [numpy.gains.everything]))).max()
    for name in ("gain", "aim", "facts", "aim_facts", "everything"):
        assert_close(getattr(native.gains, name), getattr(numpy.gains, name), name, largest)
    if abs(numpy.gains.everything) > CLOSE * largest:  # else it is what rounding leaves
        assert_close(native.scale, numpy.scale, "scale", largest)
    assert (native.beyond is None) == (numpy.beyond is None)
    if numpy.beyond is not None:
        assert_close(native.beyond.worth, numpy.beyond.worth, "worth", largest)
        for name in ("charges", "price", "until"):
            assert_close(getattr(native.beyond, name), getattr(numpy.beyond, name), name)
        assert_close(native.beyond.rent, numpy.beyond.rent, "rent", most_charged(problem, numpy.beyond.price))
    every = range(native.levels)
    for sends in ([], list(every), list(every)[::2]):
        assert_close(native.worth(sends), numpy.worth(sends), "worth", native.levels * largest)
        assert native.overfilled(sends) == numpy.overfilled(sends)
    assert_close(native.charged(), numpy.charged(), "charged")


def most_charged(problem, price):
    """What a stream that sends all it has is charged a second, at most: its rent is what is left of as much."""
    streams = defaultdict(list)
    for m in problem.messages:
        if not m.sent:
            streams[m.stream].append(m)
    most = 0.0
    for messages in streams.values():
        apart = (messages[-1].t_gen - messages[0].t_gen) / len(messages) or problem.t_end - messages[0].t_gen
        most = max(most, max(np.dot(m.use, price) for m in messages) / max(apart, 1e-6))
    return most


def assert_close(one, other, name, largest=0.0):
    """The shape is the same, and each number but for a small part of the largest."""
    one, other = np.asarray(one, dtype=np.float64), np.asarray(other, dtype=np.float64)
    assert one.shape == other.shape, name
    same = one == other
    largest = max(largest, np.abs(other[np.isfinite(other)]).max(initial=0.0))
    apart = np.abs(np.subtract(one, other, where=~same, out=np.zeros_like(one)))
    assert (apart <= CLOSE * largest).all(), (name, apart.max(), largest)


def gains_that_cancel(tau, late, delay):
    """One message ends for 1 ns what another is worth: hardly anything is left of what both gain."""
    fading, ending = Exponential(1.0, tau), Linear(0.0, 1.0)
    messages = (
        Message(0, 0.0, 0.0, late, fading, 0.5, (), sent=False),
        Message(0, 1e-9, 1e-9, late + 1e-9, ending, 0.0, (), sent=False),
    )
    return Problem((Stream(0, Aggregation.CURRENT, (Receiver(delay, 0.5),)),), messages, 0, (), (), -1.0, 1.000000001)


@given(problems(), st.booleans())
@example(gains_that_cancel(0.03125, 0.0, 0.5), False)
@example(gains_that_cancel(0.015625, 1.0, 0.0), False)
def test_any_window_has_the_same_tables(problem, beyond):
    """Whatever the kinds, the times, the receivers and the limits."""
    assert_alike(problem, beyond=beyond)


@given(st.integers(0, 2**32), st.booleans())
def test_windows_with_one_limit_or_more_have_the_same_tables(seed, beyond):
    """Also where messages are larger than a limit, and what was sent binds later."""
    problem = window(
        seed,
        robots=1 + seed % 5,
        horizon=4 + seed % 13,
        constraints=seed % 4,
        grid=seed % 2 == 0,
        goes_on=seed % 7 > 0,
        aggregations=tuple(Aggregation),
    )
    assert_alike(problem, beyond=beyond)


def single(aggregation, *messages, t_end=5.0):
    return Problem((Stream(0, aggregation),), messages, len(messages) - 1, (), (), -1.0, t_end)


@pytest.mark.parametrize("aggregation", Aggregation)
def test_one_message_alone(aggregation):
    """Nothing comes before or after it."""
    assert_alike(single(aggregation, Message(0, 0.0, 0.0, 0.1, Linear(1.0, 0.1), 1.0, ())), beyond=True)


@pytest.mark.parametrize("aggregation", Aggregation)
def test_all_at_the_same_time(aggregation):
    """Ties are taken in the order of the window."""
    one = Message(0, 0.0, 0.0, 0.0, Video(), 1.0, ())
    facts = (one._replace(sent=True), one._replace(sent=True, scale=2.0))
    assert_alike(single(aggregation, *facts, one, one, one._replace(scale=3.0)), beyond=True)


@pytest.mark.parametrize("aggregation", Aggregation)
def test_what_arrives_after_the_end(aggregation):
    """It is worth nothing, in either table."""
    late = Message(0, 0.0, 0.0, 9.0, Linear(1.0, 0.01), 1.0, ())
    problem = single(aggregation, late._replace(sent=True), late, late)
    assert_alike(problem, beyond=True)
    assert tabulate(problem).gains.everything == 0.0


def test_a_window_of_facts_beside_the_current_message():
    """Streams that have no message to decide, or none at all, are worth what is known of them."""
    fact = Message(1, 0.0, 0.0, 0.1, Exponential(1.0, 2.0), 1.0, (), sent=True)
    messages = (fact, Message(0, 1.0, 1.0, 1.1, Linear(1.0, 0.1), 1.0, ()))
    for kind in Aggregation:
        problem = Problem((Stream(0), Stream(1, kind), Stream(2, kind, ())), messages, 1, (), (), -1.0, 5.0)
        assert_alike(problem, beyond=True)


def test_more_envelopes_than_there_is_room_for():
    """Beyond 256 the nearest stands for one, nothing is proven, and the plan is worth what it is by the definition."""
    problem = crowded(40)
    tables = tabulate(problem, beyond=True)
    assert isinstance(tables, NativeTables)
    assert not tables.exact
    assert tables.states.tolist() == [256]
    for engine in ("native", "python"):
        search = start(problem, SearchSettings(engine=engine))
        search.run(300)
        plan = search.plan()
        assert plan.gap is None
        assert plan.utility == utility(problem, plan.sends)


def test_own_models_are_tabulated_with_numpy():
    """Whether it is an aggregation or a utility that is the caller's own."""

    class Flat:
        def value(self, age):
            return np.ones_like(age)

        def integral(self, start, end):
            return end - start

    good = window(3, robots=2, horizon=5)
    own = (
        dataclasses.replace(good, streams=(Stream(0, Newest()), *good.streams[1:])),
        dataclasses.replace(good, messages=tuple(m._replace(utility=Flat()) for m in good.messages)),
    )
    for problem in own:
        assert isinstance(tabulate(problem, beyond=True), NumpyTables)


ODD = {
    "a fraction": lambda m: m._replace(scale=Fraction(3, 2)),
    "a number of NumPy's": lambda m: m._replace(stream=np.int64(m.stream)),
    "a flag of NumPy's": lambda m: m._replace(sent=np.bool_(m.sent)),
    "a function of another class": lambda m: m._replace(utility=type("Other", (Linear,), {})(1.0, 0.5)),
}


@pytest.mark.parametrize("change", ODD.values(), ids=ODD.keys())
def test_what_is_not_read_in_one_pass_is_tabulated_with_numpy(change):
    """Numbers and classes of unusual types mean the same."""
    good = window(3, robots=2, horizon=5)
    good = dataclasses.replace(
        good, messages=tuple(m._replace(utility=Linear(1.0, 0.5), scale=1.5) for m in good.messages)
    )
    odd = dataclasses.replace(good, messages=tuple(map(change, good.messages)))
    tables = tabulate(odd, beyond=True)
    assert isinstance(tables, NumpyTables)
    assert_close(tabulate(good, beyond=True).gains.aim, tables.gains.aim, "aim")


def test_whole_numbers_and_lists_are_read():
    """As long as they can be numbers of floating point."""
    good = single(Aggregation.SUM, Message(0, 0, 0, 1, Linear(2, 1), 3, [1]))
    problem = dataclasses.replace(
        good, messages=list(good.messages), constraints=(Constraint("c", 1, 2),), traffic=[Traffic(0, (1,))]
    )
    assert_alike(problem, beyond=True)
    huge = dataclasses.replace(problem, messages=(problem.messages[0]._replace(t_rcv=10**400),))
    with pytest.raises(ProblemError):
        tabulate(huge)


def test_what_is_more_than_a_constraint_is_read_as_one():
    """The daemon's limits know more than the planner asks for, and so may all parts of a problem."""

    class Limit(Constraint):
        pass

    class Sample(Message):
        pass

    good = window(3, robots=2, horizon=5)
    limits = tuple(Limit(c.name, c.window, c.limit) for c in good.constraints)
    more = dataclasses.replace(good, constraints=limits, messages=tuple(Sample(*m) for m in good.messages))
    assert_alike(more, beyond=True)


def test_tables_of_numpy_answer_in_either_engine():
    """The native engine searches them, too."""
    problem = window(3, robots=2, horizon=5)
    numpy = dataclasses.replace(
        problem, messages=tuple(m._replace(stream=np.int64(m.stream)) for m in problem.messages)
    )
    for mode, engine in itertools.product(("best", "paper"), ("native", "python")):
        plans = []
        for each in (problem, numpy):
            search = start(each, SearchSettings(mode, engine))
            search.run(100)
            plans.append(search.plan())
        assert plans[0].sends == plans[1].sends
        assert plans[0].utility == pytest.approx(plans[1].utility, rel=1e-12)
