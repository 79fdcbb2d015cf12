"""How many messages a window may hold."""

import math

from hypothesis import given
from hypothesis import strategies as st

from proxy.core.window.tuning import TUNING
from proxy.core.window.window import WindowSize


def test_without_a_deadline_windows_hold_everything():
    """Whoever drives the core without one has all the time."""
    size = WindowSize(math.inf)
    size.note(1000, 10.0, thinned=False)
    assert size.messages == math.inf


def test_a_deadline_that_is_short_leaves_fewer_from_the_start():
    """The first decisions are to come in time, too."""
    assert WindowSize(1e-4).messages == TUNING.fewest_messages
    assert TUNING.fewest_messages < WindowSize(0.005).messages < WindowSize(0.02).messages


def test_decisions_that_took_too_long_make_windows_smaller_and_one_in_time_larger():
    """At most by half at once, and larger only if something was left out."""
    size = WindowSize(0.02)
    before = size.messages
    size.note(60, 0.005, thinned=False)
    assert size.messages == before
    for _ in range(TUNING.overruns):
        size.note(60, 1.6 * TUNING.overhead * 0.02, thinned=False)
    assert size.messages == 37
    for _ in range(TUNING.overruns):
        size.note(37, 5.0, thinned=True)
    assert size.messages < 18
    smallest = size.messages
    size.note(18, 0.001, thinned=True)
    assert smallest < size.messages < 1.2 * smallest


def test_a_delay_now_and_then_leaves_windows_as_they_are():
    """On a busy machine single decisions take long, however small their windows."""
    size = WindowSize(0.02)
    before = size.messages
    for number in range(40):
        size.note(60, math.inf if number % TUNING.overruns else 0.001, thinned=False)
    assert size.messages == before


@given(st.lists(st.tuples(st.integers(0, 500), st.floats(0.0, 5.0) | st.just(math.inf), st.booleans()), max_size=60))
def test_some_messages_always_have_places(decisions):
    """Whatever decisions take, even where they never come."""
    size = WindowSize(0.02)
    for held, overhead, thinned in decisions:
        size.note(held, overhead, thinned=thinned)
        assert TUNING.fewest_messages <= size.messages < math.inf


@given(st.floats(1e-5, 2e-3), st.integers(50, 400))
def test_windows_find_the_size_that_comes_in_time(each, full):
    """Where what they take grows with the messages, for any price of one: they are in time, and not far too small."""
    size = WindowSize(0.02)
    for _ in range(100):
        held = min(full, int(size.messages))
        size.note(held, each * held, thinned=held < full)
    fitting = TUNING.overhead * 0.02 / each
    assert (
        min(full, max(TUNING.fewest_messages, 0.4 * fitting))
        <= min(full, size.messages)
        <= max(TUNING.fewest_messages, 1.2 * fitting)
    )
