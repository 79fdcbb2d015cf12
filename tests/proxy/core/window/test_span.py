"""How many messages a window may hold."""

import math

from hypothesis import given
from hypothesis import strategies as st

from proxy.core.window.span import Span
from proxy.core.window.tuning import TUNING


def test_without_a_deadline_windows_hold_everything():
    """Whoever drives the core without one has all the time."""
    span = Span(math.inf)
    span.note(1000, 10.0, thinned=False)
    assert span.most == math.inf


def test_a_deadline_that_is_short_leaves_fewer_from_the_start():
    """The first decisions are to come in time, too."""
    assert Span(1e-4).most == TUNING.fewest_messages
    assert TUNING.fewest_messages < Span(0.005).most < Span(0.02).most


def test_decisions_that_took_too_long_make_windows_smaller_and_one_in_time_larger():
    """At most by half at once, and larger only if something was left out."""
    span = Span(0.02)
    before = span.most
    span.note(60, 0.005, thinned=False)
    assert span.most == before
    for _ in range(TUNING.overruns):
        span.note(60, 1.6 * TUNING.overhead * 0.02, thinned=False)
    assert span.most == 37
    for _ in range(TUNING.overruns):
        span.note(37, 5.0, thinned=True)
    assert span.most < 18
    smallest = span.most
    span.note(18, 0.001, thinned=True)
    assert smallest < span.most < 1.2 * smallest


def test_a_delay_now_and_then_leaves_windows_as_they_are():
    """On a busy machine single decisions take long, however small their windows."""
    span = Span(0.02)
    before = span.most
    for number in range(40):
        span.note(60, math.inf if number % TUNING.overruns else 0.001, thinned=False)
    assert span.most == before


@given(st.lists(st.tuples(st.integers(0, 500), st.floats(0.0, 5.0) | st.just(math.inf), st.booleans()), max_size=60))
def test_some_messages_always_have_places(decisions):
    """Whatever decisions take, even where they never come."""
    span = Span(0.02)
    for held, overhead, thinned in decisions:
        span.note(held, overhead, thinned=thinned)
        assert TUNING.fewest_messages <= span.most < math.inf


@given(st.floats(1e-5, 2e-3), st.integers(50, 400))
def test_windows_find_the_size_that_comes_in_time(each, full):
    """Where what they take grows with the messages, for any price of one: they are in time, and not far too small."""
    span = Span(0.02)
    for _ in range(100):
        held = min(full, int(span.most))
        span.note(held, each * held, thinned=held < full)
    fitting = TUNING.overhead * 0.02 / each
    assert (
        min(full, max(TUNING.fewest_messages, 0.4 * fitting))
        <= min(full, span.most)
        <= max(TUNING.fewest_messages, 1.2 * fitting)
    )
