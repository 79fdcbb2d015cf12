"""How much of what others say is taken in."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.bridge.budget import Bucket, Budget


@given(st.lists(st.tuples(st.floats(0.0, 1.0), st.floats(0.1, 3.0)), max_size=200))
def test_no_more_is_taken_than_came_and_was_kept(steps):
    """Whenever it is asked for, and however much at a time; a clock that stands still brings nothing."""
    bucket, now, taken = Bucket(0.0, 5.0, 10.0), 0.0, 0.0
    for passed, cost in steps:
        now += passed
        taken += cost * bucket.take(now, cost)
        assert taken <= 10.0 + 5.0 * now + 1e-6


def test_what_cannot_be_used_elsewhere_is_given_back():
    """Where two buckets have to have room."""
    bucket = Bucket(0.0, 1.0, 1.0)
    assert bucket.take(0.0)
    assert not bucket.take(0.0)
    bucket.give_back()
    assert bucket.take(0.0)


@pytest.mark.parametrize("robots", [2, 50])
def test_who_says_too_much_takes_nothing_from_the_others(robots):
    """Whatever one of them, and those that nobody knows, say: each other one has its part."""
    budget = Budget(10.0, 100.0, lambda: robots)
    part = min(10.0, 100.0 / (robots + 1))
    admitted = dict.fromkeys(("loud", "", "calm"), 0)
    for step in range(10_000):
        now = step / 100
        for name in ("loud", "") * 5:
            admitted[name] += budget.admits(now, name)
        if step % 100 == 0:  # once a second
            admitted["calm"] += budget.admits(now, "calm")
    assert admitted["calm"] == 100
    for name in ("loud", ""):
        assert admitted[name] == pytest.approx(10.0 + part * 100.0, abs=2.0)


def test_senders_that_left_are_forgotten():
    """There are no more of them than twice as many as are known."""
    budget = Budget(10.0, 100.0, lambda: 3)
    for number in range(1000):
        budget.admits(0.0, str(number))
        assert len(budget._buckets) <= 9
