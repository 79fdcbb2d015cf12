"""The inbox: bounded, the latest of a Markovian stream wins, priority first."""

from hypothesis import given
from hypothesis import strategies as st

from proxy.core.inbox import Evicted, Inbox, Waiting


def waiting(sample, key="a", *, t_gen=0.0, scale=1.0, priority=5, size=100, markovian=True):
    return Waiting(sample, key, size, t_gen, scale, priority, markovian)


def test_a_newer_sample_of_a_markovian_stream_replaces_the_waiting_one():
    """The older one leaves as superseded."""
    inbox = Inbox(10)
    assert inbox.put(waiting(1)) is None
    assert inbox.put(waiting(2)) == Evicted(1, "dropped:superseded")
    assert inbox.put(waiting(3, key="b")) is None
    assert {w.sample for w in inbox} == {2, 3}


def test_samples_of_other_streams_all_wait():
    """Without the Markovian property nothing is replaced."""
    inbox = Inbox(10)
    assert inbox.put(waiting(1, markovian=False)) is None
    assert inbox.put(waiting(2, markovian=False)) is None
    assert len(inbox) == 2


def test_the_highest_priority_comes_first_then_the_oldest():
    """Zenoh's priority 1 is the highest."""
    inbox = Inbox(10)
    inbox.put(waiting(1, "a", t_gen=1.0, priority=5))
    inbox.put(waiting(2, "b", t_gen=0.5, priority=5))
    inbox.put(waiting(3, "c", t_gen=2.0, priority=2))
    assert [inbox.take().sample for _ in range(3)] == [3, 2, 1]
    assert inbox.take() is None


def test_overflow_evicts_what_is_worth_least_per_byte():
    """It may be the new sample itself."""
    inbox = Inbox(2)
    inbox.put(waiting(1, "a", scale=5.0))
    inbox.put(waiting(2, "b", scale=1.0))
    assert inbox.put(waiting(3, "c", scale=3.0)) == Evicted(2, "dropped:overflow")
    assert inbox.put(waiting(4, "d", scale=0.1)) == Evicted(4, "dropped:overflow")


@given(st.lists(st.tuples(st.integers(0, 4), st.booleans(), st.floats(0, 10)), max_size=60), st.integers(1, 5))
def test_every_sample_leaves_exactly_once_and_the_bound_holds(arrivals, capacity):
    """What went in is in the inbox, was evicted or was taken, and never twice."""
    inbox, gone = Inbox(capacity), []
    for sample, (key, markovian, scale) in enumerate(arrivals):
        evicted = inbox.put(waiting(sample, f"k{key}{markovian}", scale=scale, markovian=markovian))
        gone += [evicted.sample] if evicted else []
        assert len(inbox) <= capacity
    while (taken := inbox.take()) is not None:
        gone.append(taken.sample)
    assert sorted(gone) == list(range(len(arrivals)))
