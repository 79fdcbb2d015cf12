"""What holds for every kind of message utility."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner import Linear, Message, Problem, SearchSettings, Stream, start
from planner.received import integrals
from planner.utility import Batched, integral
from tests.planner.utility.kinds import ages, alike, by_quadrature, falling, spans, utilities


def area(utility, begin, end) -> float:
    return float(utility.integral(np.array([begin]), np.array([end]))[0])


@given(utilities, spans)
def test_integral_equals_quadrature(utility, span):
    """The closed form of the integral agrees with numerical quadrature between any two ages."""
    assert area(utility, *span) == pytest.approx(by_quadrature(utility, *span), rel=1e-6, abs=1e-8)


@given(utilities, ages)
def test_one_message_is_worth_what_each_of_many_is(utility, age):
    """Whichever language says it."""
    assert integral(utility, age) == pytest.approx(area(utility, 0.0, age), rel=1e-12, abs=1e-12)


def test_one_message_of_an_operators_own_kind_is_worth_what_that_says():
    """Even where it is derived from one that the planner knows."""

    class Twice(Linear):
        def integral(self, start, end):
            return 2.0 * super().integral(start, end)

    assert integral(Twice(1.0, 0.5), 1.0) == 2.0 * integral(Linear(1.0, 0.5), 1.0) > 0.0


@given(utilities, st.tuples(ages, ages, ages).map(sorted))
def test_integrals_of_adjacent_intervals_add_up(utility, times):
    """What a message is worth from a to b and from b to c, it is from a to c."""
    a, b, c = times
    assert area(utility, a, b) + area(utility, b, c) == pytest.approx(area(utility, a, c), rel=1e-9, abs=1e-9)


@given(alike, st.data())
def test_many_messages_integrate_as_each_alone(messages, data):
    """The batched integral of a kind gives what each of its messages gives alone, in any order and number."""
    kind = type(messages[0])
    assert issubclass(kind, Batched)
    which = np.array(data.draw(st.lists(st.integers(0, len(messages) - 1), min_size=1, max_size=8)))
    drawn = data.draw(st.lists(spans, min_size=len(which), max_size=len(which)))
    begin, end = np.array(drawn).T
    batch = kind.integrals(messages, which, begin, end)
    alone = [area(messages[at], *span) for at, span in zip(which, drawn, strict=True)]
    assert batch.tolist() == pytest.approx(alone, rel=1e-12, abs=1e-12)


@given(st.lists(utilities, min_size=1, max_size=8), spans)
def test_messages_of_several_kinds_integrate_as_each_alone(messages, span):
    """The evaluation of a window takes kinds together and mixes nothing up."""
    which = np.arange(len(messages))
    begin, end = (np.full(len(messages), age) for age in span)
    alone = [area(message, *span) for message in messages]
    assert integrals(messages, which, begin, end).tolist() == pytest.approx(alone, rel=1e-12, abs=1e-12)


@given(utilities, st.lists(st.floats(-10, 1000), min_size=1))
def test_values_are_finite_and_never_negative_and_nothing_before_the_message_exists(utility, at):
    """At every age, 0 included."""
    values = utility.value(np.array([-1e-9, 0.0, *at]))
    assert np.isfinite(values).all()
    assert (values >= -1e-12).all()
    assert (values[np.array([-1e-9, 0.0, *at]) < 0] == 0).all()


@given(utilities, spans)
def test_integrals_are_finite_and_never_negative(utility, span):
    """Nobody loses by having a message."""
    worth = area(utility, *span)
    assert np.isfinite(worth)
    assert worth >= -1e-9
    assert area(utility, span[0], span[0]) == 0


@given(st.one_of(*falling.values()), st.lists(ages, min_size=2))
def test_value_never_rises_with_age(utility, at):
    """A message is worth most when fresh."""
    values = utility.value(np.array(sorted(at)))
    assert (np.diff(values) <= 1e-9 * (1 + values[0])).all()


@given(utilities, st.integers(1, 3))
def test_arrays_of_any_shape_are_integrated(utility, rows):
    """The shape of the ages is that of the integrals."""
    at = np.arange(4.0 * rows).reshape(rows, 4)
    assert utility.integral(at, at + 1).shape == at.shape
    assert utility.value(at).shape == at.shape


@given(utilities)
def test_a_utility_equals_one_with_the_same_parameters_and_hashes_like_it(utility):
    """Utilities are values: what was computed from the parameters does not count."""
    again = type(utility)(*(getattr(utility, name) for name in parameters(utility)))
    assert again == utility
    assert hash(again) == hash(utility)


@given(st.lists(utilities, min_size=2, max_size=6))
def test_a_window_takes_every_kind(messages):
    """Messages of any kinds make a problem, and a search answers it."""
    window = Problem(
        streams=(Stream(0),),
        messages=tuple(Message(0, float(at), float(at), at + 0.1, u, 1.0, ()) for at, u in enumerate(messages)),
        current=0,
        constraints=(),
        traffic=(),
        t_start=0.0,
        t_end=len(messages) + 1.0,
    )
    search = start(window, SearchSettings(search="best", engine="python"), seed=1)
    search.run(10)
    assert np.isfinite(search.plan().utility)


def parameters(utility) -> list[str]:
    return [name for name, field in utility.__dataclass_fields__.items() if field.init]
