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


def test_what_is_owed_is_paid_first():
    """A burst at most, so that there is room again soon."""
    bucket = Bucket(0.0, 1.0, 2.0)
    bucket.owe(0.0, 100.0)
    assert not bucket.take(2.5)
    assert bucket.take(3.0)


@pytest.mark.parametrize("robots", [2, 50])
def test_who_says_too_much_takes_nothing_from_the_others(robots):
    """Whatever one of them, and those that nobody knows, say: each other one has its part."""
    budget = Budget(10.0, 100.0, lambda: robots)
    admitted = dict.fromkeys(("loud", "", "calm"), 0)
    for step in range(10_000):
        now = step / 100
        for name in ("loud", "") * 5:
            admitted[name] += budget.admits(now, name)
        if step % 100 == 0:  # once a second
            admitted["calm"] += budget.admits(now, "calm")
    assert admitted["calm"] == 100
    for name in ("loud", ""):
        assert admitted[name] == pytest.approx(10.0 + 10.0 * 100.0, abs=2.0)


@pytest.mark.full
def test_many_that_say_too_much_leave_each_its_part():
    """All together cause no more than they may, but for what they have saved."""
    budget = Budget(10.0, 100.0, lambda: 49)
    loud = [str(number) for number in range(40)]
    calm, admitted = 0, 0
    for step in range(10_000):
        now = step / 100
        admitted += sum(budget.admits(now, name) for name in loud)
        if step % 100 == 0:  # once a second
            calm += budget.admits(now, "calm")
    assert calm == 100
    assert admitted <= 100.0 * 100.0 + 100.0 + 10.0 * len(loud)


def test_who_says_nothing_takes_nothing_from_the_others():
    """However many they are: what each says for certain is little then, and all that it may as nobody else does."""
    budget = Budget(10.0, 100.0, lambda: 999)
    assert sum(budget.admits(step / 100, "one") for step in range(10_000)) == pytest.approx(10.0 + 1000.0, abs=2.0)


def test_senders_that_left_are_forgotten():
    """There are no more of them than twice as many as are known."""
    budget = Budget(10.0, 100.0, lambda: 3)
    for number in range(1000):
        budget.admits(0.0, str(number))
        assert len(budget._buckets) <= 9
