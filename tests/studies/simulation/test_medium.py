"""The simulated medium."""

import pytest

from studies.simulation.medium import REORDERED, RETRY, Medium, Way

ALL = ("b", "c", "d")


def arrivals(medium, count=2000, size=10):
    """When `count` messages arrive that a sends to b every 10 ms."""
    return [medium.unicast(0.01 * i, size, "a", ("b",))["b"] for i in range(count)]


def test_unicast_takes_a_copy_for_each_and_broadcast_one_for_all():
    """Copies queue behind each other; a broadcast reaches all at once."""
    medium = Medium(1000.0, delay=0.5)
    assert medium.unicast(0.0, 100, "a", ALL) == {"b": [0.6], "c": [0.7], "d": [pytest.approx(0.8)]}
    assert medium.broadcast(10.0, 100, "a", ALL) == {key: [10.6] for key in ALL}
    assert medium.carried == 400


def test_a_lower_rate_makes_a_queue_that_shows():
    """From the time of the change on every byte takes longer, and what comes after it waits."""
    medium = Medium(1000.0, delay=0.0, rates=((5.0, 100.0), (8.0, 1000.0)))
    assert medium.air(1.0, 100) == pytest.approx(1.1)
    assert medium.air(5.0, 100) == pytest.approx(6.0)
    assert medium.air(5.0, 100) == pytest.approx(7.0)
    assert medium.air(8.0, 100) == pytest.approx(8.1)


@pytest.mark.parametrize("loss", [0.1, 0.3])
def test_so_many_are_lost(loss):
    """The part that is asked for, of each receiver on its own."""
    medium = Medium(1e6, loss=loss)
    lost = [len(medium.broadcast(0.01 * i, 10, "a", ALL)[r]) == 0 for i in range(2000) for r in ALL]
    assert sum(lost) / len(lost) == pytest.approx(loss, abs=0.03)


def test_some_arrive_twice_and_some_are_overtaken():
    """Duplicates come later; without reordering what was sent first arrives first."""
    twice = arrivals(Medium(1e6, duplication=0.1))
    assert sum(len(each) == 2 for each in twice) == pytest.approx(200, abs=60)
    assert all(each[1] == pytest.approx(each[0] + REORDERED) for each in twice if len(each) == 2)
    jittered = [each[0] for each in arrivals(Medium(1e6, jitter=0.05))]
    assert jittered == sorted(jittered)
    overtaken = [each[0] for each in arrivals(Medium(1e6, reordering=0.1))]
    assert overtaken != sorted(overtaken)


def test_jitter_delays_by_its_mean():
    """On average, on a medium that nothing waits for."""
    medium = Medium(1e9, delay=0.1, jitter=0.05)
    late = [medium.unicast(10.0 * i, 1, "a", ("b",))["b"][0] - 10.0 * i - 0.1 for i in range(2000)]
    assert min(late) >= 0.0
    assert sum(late) / len(late) == pytest.approx(0.05, rel=0.1)


def test_pairs_differ_and_do_not_disturb_each_other():
    """A pair has a way of its own, and the same fate whatever others send."""
    far = {("a", "c"): Way(delay=1.0)}
    assert Medium(1e9, delay=0.0, ways=dict(far)).broadcast(0.0, 0, "a", ("b", "c")) == {"b": [0.0], "c": [1.0]}
    alone, busy = Medium(1e9, loss=0.5, seed=3), Medium(1e9, loss=0.5, seed=3)
    for i in range(50):
        busy.unicast(float(i), 0, "c", ("b",))
        assert alone.unicast(float(i), 0, "a", ("b",)) == busy.unicast(float(i), 0, "a", ("b",))


def test_what_is_reliable_arrives_later_instead_of_never():
    """A loss costs the time until it is sent again."""
    sure, unsure = Medium(1e6), Medium(1e6, loss=0.5)
    least = sure.reliable(0.0, "a", "b")
    late = [unsure.reliable(0.0, "a", "b") - least for _ in range(100)]
    assert min(late) == 0.0
    assert max(late) >= 2 * RETRY
