"""Deletions keep their place among the samples of their key."""

from proxy.core.model.waiting import Waiting
from proxy.core.samples.deletions import Deletions


def waiting(sample, key="a"):
    return Waiting(sample, key, 100, 0.0, 1.0, 5, markovian=False)


def test_a_deletion_passes_behind_all_that_was_undecided_of_its_key():
    """Other keys do not hold it up."""
    deletions = Deletions()
    deletions.add(9, "a", [waiting(1), waiting(2), waiting(3, "b")])
    assert deletions.due([waiting(2), waiting(3, "b")]) == []
    assert deletions.due([waiting(3, "b")]) == [9]
    assert deletions.due([]) == []


def test_with_nothing_before_it_a_deletion_is_due_at_once():
    """In the order in which they came."""
    deletions = Deletions()
    deletions.add(8, "a", [waiting(3, "b")])
    deletions.add(9, "b", [])
    assert deletions.due([waiting(3, "b")]) == [8, 9]


def test_what_comes_after_a_deletion_is_held_until_it_passed():
    """What came before it is not, nor another key."""
    deletions = Deletions()
    deletions.add(9, "a", [waiting(1)])
    assert [deletions.holds(each) for each in (waiting(1), waiting(10), waiting(11, "b"))] == [False, True, False]
    deletions.due([])
    assert not deletions.holds(waiting(10))
