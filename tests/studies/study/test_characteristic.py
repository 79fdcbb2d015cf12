"""The characteristic of §4.1."""

import numpy as np
import pytest

from planner import Aggregation, Linear, Message, Problem, Step, Stream
from studies.study.characteristic import Characteristic, at_random, gains, of_runs
from studies.study.errors import StudyError
from studies.workload import FEW_IMPORTANT, MIXED, MOST_IMPORTANT, mission

END = 20.0


class Own:
    """An aggregation of one's own."""


def problem(*messages, aggregation=Aggregation.MOST_RECENT):
    """Messages of one stream: when they are generated, utility, scale; they arrive at once."""
    made = tuple(Message(0, t, t, t, utility, scale, ()) for t, utility, scale in messages)
    return Problem((Stream(0, aggregation),), made, 0, (), (), 0.0, END)


def all_of(one):
    return gains(one, {i: m.t_rcv for i, m in enumerate(one.messages)}).tolist()


@pytest.mark.parametrize("aggregation", [Aggregation.MOST_RECENT, Aggregation.CURRENT])
def test_the_newest_is_of_use_until_the_next_comes(aggregation):
    """The first one fades from 1 to 0.5 in that time; the second one to 0 in ten seconds, and then is of no use."""
    fading = Linear(1.0, 0.1)
    assert all_of(problem((0.0, fading, 1.0), (5.0, fading, 2.0), aggregation=aggregation)) == pytest.approx(
        [0.75, 1.0], rel=0.02
    )


def test_what_was_not_received_gains_nothing_and_gives_no_way():
    """The first is of use to its end then."""
    one = problem((0.0, Linear(1.0, 0.1), 1.0), (5.0, Linear(1.0, 0.1), 2.0))
    assert gains(one, {0: 0.0}).tolist() == pytest.approx([0.5], rel=0.02)
    assert gains(one, {0: END + 1.0}).tolist() == []


def test_messages_that_add_up_are_of_use_as_long_as_they_are_worth_anything():
    """Whatever comes after them."""
    lasting = Step(1.0, 4.0)
    found = all_of(problem((0.0, lasting, 1.0), (1.0, lasting, 3.0), aggregation=Aggregation.SUM))
    assert found == pytest.approx([1.0, 3.0], rel=0.02)


def test_of_the_best_only_the_time_counts_in_which_they_are():
    """One that never is gains nothing."""
    lasting = Step(1.0, 4.0)
    messages = (0.0, lasting, 2.0), (1.0, lasting, 1.0), (2.0, lasting, 3.0), (2.0, lasting, 0.5)
    assert all_of(problem(*messages, aggregation=Aggregation.BEST)) == pytest.approx([2.0, 0.0, 3.0, 0.0], rel=0.02)


def test_after_the_first_nothing_counts_where_one_is_enough():
    """As ONCE has it."""
    lasting = Step(1.0, 100.0)
    found = all_of(problem((0.0, lasting, 2.0), (1.0, lasting, 1.0), aggregation=Aggregation.ONCE))
    assert found == pytest.approx([2.0, 0.0])


def test_what_shows_too_much_loses_by_it():
    """As long as the newest message, received or not, is worth less: here two of four seconds, and then for ever."""
    lasting = Step(1.0, 100.0)
    one = problem((0.0, lasting, 3.0), (2.0, lasting, 1.0), (4.0, lasting, 2.0), aggregation=Aggregation.CURRENT)
    assert gains(one, {0: 0.0, 2: 4.0}).tolist() == pytest.approx([2.0, 2.0])
    assert gains(one, {0: 0.0}).tolist() == pytest.approx([(3 * 20 - 2 * 2 - 16) / 20])
    assert (
        gains(problem((0.0, Step(1.0, 1.0), 3.0), (1.0, lasting, 0.0), aggregation=Aggregation.CURRENT), {0: 0.0})
        == 0.0
    )


def test_an_aggregation_of_ones_own_is_refused():
    """Nobody says what one message of it is worth."""
    one = problem((0.0, Step(1.0, 1.0), 1.0), aggregation=Own())
    with pytest.raises(StudyError, match="of its own"):
        all_of(one)


@pytest.mark.full
def test_the_three_scenarios_are_what_they_are_called():
    """Most messages are of high utility, as many of each level, and few of high utility."""
    most, mixed, few = (
        Characteristic.of(at_random(mission(scenario, 0), 0)) for scenario in (MOST_IMPORTANT, MIXED, FEW_IMPORTANT)
    )
    assert most.levels["low"] < 0.15
    assert min(mixed.levels.values()) > 0.15
    assert few.levels["low"] > 0.7
    assert most.best_half < mixed.best_half < few.best_half
    assert few.best_half > 0.95


def test_parts_add_up():
    """Levels, histogram and eCDF are parts of all messages."""
    found = Characteristic.of([4.0, 1.0, 2.0, 3.0])
    assert found.utilities.tolist() == [0.25, 0.5, 0.75, 1.0]
    assert found.levels == {"low": 0.25, "medium": 0.25, "high": 0.5}
    assert found.histogram().sum() == pytest.approx(1.0)
    assert [found.below(each) for each in (0.0, 0.5, 1.0)] == [0.0, 0.5, 1.0]
    assert found.best_half == pytest.approx(0.7)


@pytest.mark.parametrize("gained", [[], [0.0, 0.0]])
def test_nothing_that_is_worth_anything_has_no_characteristic(gained):
    """Which is said."""
    with pytest.raises(StudyError, match="nothing to characterise"):
        Characteristic.of(gained)


@pytest.mark.full
def test_the_same_seed_drops_the_same():
    """And another one others."""
    one = mission(MIXED, 0, seconds=20.0)
    assert np.array_equal(at_random(one, 1), at_random(one, 1))
    assert not np.array_equal(at_random(one, 1), at_random(one, 2))


def test_of_many_gains_some_are_kept():
    """Each with four digits."""
    assert of_runs([1.23456, 2.0], 5) == [1.235, 2.0]
    assert len(of_runs(np.arange(100.0), 7)) == 7
