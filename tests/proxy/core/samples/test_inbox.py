"""The inbox: bounded, the latest of a Markovian stream wins, priority first."""

import math

from hypothesis import given
from hypothesis import strategies as st

from proxy.core.model.waiting import Waiting
from proxy.core.samples.inbox import Evicted, Inbox


def waiting(sample, key="a", *, t_gen=0.0, scale=1.0, priority=5, size=100, markovian=True):
    return Waiting(sample, key, size, t_gen, scale, priority, markovian)


def test_a_newer_sample_of_a_markovian_stream_replaces_the_waiting_one():
    """The older one leaves as superseded."""
    inbox = Inbox(10, 5)
    assert inbox.put(waiting(1)) == []
    assert inbox.put(waiting(2)) == [Evicted(1, "dropped:superseded", "a")]
    assert inbox.put(waiting(3, key="b")) == []
    assert {w.sample for w in inbox} == {2, 3}


def test_samples_of_other_streams_all_wait():
    """Without the Markovian property nothing is replaced."""
    inbox = Inbox(10, 5)
    assert inbox.put(waiting(1, markovian=False)) == []
    assert inbox.put(waiting(2, markovian=False)) == []
    assert inbox.supersede("a") == []
    assert len(inbox) == 2


def test_of_a_stream_with_too_many_the_least_valuable_leaves_and_of_equals_the_oldest():
    """Whatever room the inbox has, and whatever it is worth per byte; it may be the new one."""
    inbox = Inbox(10, 2)
    inbox.put(waiting(1, t_gen=1.0, scale=2.0, size=9, markovian=False))
    inbox.put(waiting(2, t_gen=2.0, scale=2.0, size=1, markovian=False))
    inbox.put(waiting(3, "b", scale=0.1, markovian=False))
    assert inbox.put(waiting(4, t_gen=3.0, scale=3.0, markovian=False)) == [Evicted(1, "dropped:overflow", "a")]
    assert inbox.put(waiting(5, t_gen=4.0, scale=1.0, markovian=False)) == [Evicted(5, "dropped:overflow", "a")]


def test_a_stream_that_becomes_markovian_keeps_the_newest_only():
    """New specs may say so while samples wait."""
    inbox = Inbox(10, 5)
    inbox.put(waiting(1, markovian=False))
    inbox.put(waiting(2, markovian=False))
    assert inbox.put(waiting(3)) == [Evicted(1, "dropped:superseded", "a"), Evicted(2, "dropped:superseded", "a")]
    assert inbox.supersede("a") == [Evicted(3, "dropped:superseded", "a")]


def test_the_highest_priority_comes_first_then_the_oldest():
    """Zenoh's priority 1 is the highest; what is held back waits."""
    inbox = Inbox(10, 5)
    inbox.put(waiting(1, "a", t_gen=1.0, priority=5))
    inbox.put(waiting(2, "b", t_gen=0.5, priority=5))
    inbox.put(waiting(3, "c", t_gen=2.0, priority=2))
    assert inbox.take(lambda w: w.sample == 3).sample == 2
    assert [inbox.take().sample for _ in range(2)] == [3, 1]
    assert inbox.take() is None


def test_overflow_evicts_what_is_worth_least_per_byte():
    """It may be the new sample itself."""
    inbox = Inbox(2, 5)
    inbox.put(waiting(1, "a", scale=5.0))
    inbox.put(waiting(2, "b", scale=1.0))
    assert inbox.put(waiting(3, "c", scale=3.0)) == [Evicted(2, "dropped:overflow", "b")]
    assert inbox.put(waiting(4, "d", scale=0.1)) == [Evicted(4, "dropped:overflow", "d")]


def test_bytes_are_bounded_too_and_one_sample_counts_as_half_of_them_at_most():
    """So one of any size may wait, with others beside it."""
    inbox = Inbox(10, 5, 1000)
    assert inbox.put(waiting(1, "large", size=40_000_000)) == []
    assert inbox.put(waiting(2, "a", size=500, scale=9.0)) == []
    assert inbox.put(waiting(3, "b", size=1, scale=9.0)) == [Evicted(1, "dropped:overflow", "large")]
    assert inbox.put(waiting(4, "c", size=499)) == []
    assert inbox.put(waiting(5, "d", size=600)) == [Evicted(5, "dropped:overflow", "d")]


def test_it_is_full_for_what_another_one_would_have_to_leave_for():
    """For want of places or bytes, or because too many wait of a stream of which each counts."""
    inbox = Inbox(3, 2, 1000)
    inbox.put(waiting(1, "a", markovian=False))
    assert not inbox.full(waiting(2, "a", markovian=False))
    inbox.put(waiting(2, "a", markovian=False))
    assert inbox.full(waiting(3, "a", markovian=False))
    assert not inbox.full(waiting(3, "b", size=5000))
    inbox.put(waiting(3, "b", size=5000))
    assert inbox.full(waiting(4, "c"))
    assert inbox.take().sample == 1
    assert inbox.full(waiting(4, "c", size=500))
    assert not inbox.full(waiting(4, "c"))


@given(
    st.lists(st.tuples(st.integers(0, 4), st.booleans(), st.floats(0, 10)), max_size=60),
    st.integers(1, 8),
    st.integers(1, 4),
)
def test_every_sample_leaves_exactly_once_and_the_bounds_hold(arrivals, capacity, backlog):
    """What went in is in the inbox, was evicted or was taken, and never twice; streams may change their ways."""
    inbox, gone = Inbox(capacity, backlog), []
    for sample, (key, markovian, scale) in enumerate(arrivals):
        evicted = inbox.put(waiting(sample, f"k{key}", scale=scale, markovian=markovian))
        gone += [each.sample for each in evicted]
        keys = [w.key for w in inbox]
        assert len(inbox) <= capacity
        assert all(keys.count(each) <= (1 if markovian and each == f"k{key}" else backlog) for each in keys)
    while (taken := inbox.take()) is not None:
        gone.append(taken.sample)
    assert sorted(gone) == list(range(len(arrivals)))


@given(st.lists(st.tuples(st.integers(0, 2), st.floats(0, 10)), max_size=40), st.integers(1, 4))
def test_what_stays_of_a_stream_is_worth_no_less_than_what_left(arrivals, backlog):
    """The best of all that came, not the first or the last."""
    inbox, left = Inbox(1000, backlog), {}
    for sample, (key, scale) in enumerate(arrivals):
        for evicted in inbox.put(waiting(sample, f"k{key}", t_gen=sample, scale=scale, markovian=False)):
            left.setdefault(f"k{key}", []).append(arrivals[evicted.sample][1])
    for key, scales in left.items():
        assert max(scales) <= min(w.scale for w in inbox if w.key == key)


def test_what_rests_is_given_out_when_its_time_has_come():
    """Until then it is not even looked at; what else waits goes first."""
    inbox, looked_at = Inbox(10, 5), []

    def held(sample):
        looked_at.append(sample.sample)
        if sample.sample == 1:
            inbox.rest(sample, 3.0)
        return sample.sample == 1

    for sample, key in enumerate("abc", 1):
        inbox.put(waiting(sample, key))
    assert [inbox.take(held).sample for _ in range(2)] == [2, 3]
    assert (inbox.take(held), inbox.wakes_at, inbox.rests_until(1)) == (None, 3.0, 3.0)
    inbox.wake(2.9)
    assert inbox.take(held) is None
    assert looked_at == [1, 2, 3]
    inbox.wake(3.0)
    assert inbox.wakes_at == math.inf
    assert inbox.take().sample == 1


def test_nobody_waits_for_a_sample_that_left_while_it_rested():
    """Whether something newer came or all was taken out; put back, it can be taken at once."""
    inbox = Inbox(10, 5)
    inbox.put(waiting(1))
    inbox.rest(waiting(1), 3.0)
    inbox.put(waiting(2))
    assert inbox.wakes_at == math.inf
    inbox.rest(waiting(2), 4.0)
    inbox.put_back(inbox.clear())
    assert (inbox.wakes_at, inbox.take().sample) == (math.inf, 2)
