"""Messages larger than a limit lets pass in its window, and what goes beside them."""

import itertools
import math
from dataclasses import replace

import pytest

from planner.measures import Throughput
from proxy.core.coordination.tuning import TUNING
from proxy.core.model.limits import Limit
from tests.proxy.core.coordination.conftest import BYTES, COUNT, heard


def test_a_message_larger_than_the_limit_has_the_window_stretched_for_it(make_budget):
    """It goes when what was sent for as long as its bytes take leaves it room, and only little goes for as long."""
    budget, view = make_budget()
    heard(view, 1.0, 600)
    large = (2500.0,)
    budget.stretch.weigh(budget.limits, (0.0,), [(large, (0.0,))])
    longer = BYTES.window * 2.5 / (1.0 - TUNING.beside_oversized)
    assert budget.lacking(3.4, large)
    assert not budget.lacking(3.6, large), "nothing was sent for as long as its bytes take"
    begin = 3.6
    budget.use(begin, large)
    for now in (begin, begin + 1.5):
        assert budget.lacking(now, (200.0,))
        assert not budget.lacking(now, (60.0,))
        assert budget.opens(now, (200.0,)) == pytest.approx(begin + longer, abs=0.01)
        budget.use(now, (60.0,))
    assert budget.lacking(begin + 2.0, (60.0,))
    assert budget.lacking(begin + longer - 0.1, large)
    assert budget.opens(begin + longer - 0.1, large) == pytest.approx(begin + longer, abs=0.01)
    assert not budget.lacking(begin + longer + 0.1, large), "beside what little was sent"


def test_a_message_larger_than_the_limit_has_room_beside_what_is_booked(make_budget):
    """The window is as much longer as that takes; small messages have their part of each window, no more."""
    budget, view = make_budget()
    budget.stretch.weigh(budget.limits, (400.0,), [((1100.0,), (0.0,))])
    for number in range(40):
        heard(view, 0.1 * number, 40)
    large, small, sent = (1100.0,), (40.0,), list[float]()
    longer = BYTES.window * 1.1 / (0.6 - TUNING.beside_oversized)
    assert budget.problem_limits(4.0).windows == (pytest.approx(longer),)
    for number in range(80):
        now = 4.0 + 0.1 * number
        if not budget.lacking(now, large):
            budget.use(now, large)
            sent.append(now)
        assert not budget.lacking(now, small), now
        assert budget.opens(now, small) < now + 0.01
        budget.use(now, small)
        assert budget.lacking(now, (540.0,)) or now >= sent[-1] + longer
    assert len(sent) == 4
    assert all(longer <= later - earlier < longer + 0.1 for earlier, later in itertools.pairwise(sent))


def test_who_keeps_to_an_equal_part_sends_what_is_larger_beside_its_own_small_messages(make_budget):
    """Whatever others say; as often as the part has room for it."""
    budget, view = make_budget(peers=3)
    budget.coordination.keeps = 0.25
    budget.stretch.weigh(budget.usable(0.0), (50.0,), [((600.0,), (0.0,))])
    assert not budget.turns
    sent = list[float]()
    for number in range(200):
        now = 0.1 * number
        heard(view, now, 500)
        budget.use(now, (5.0,))
        if not budget.lacking(now, (600.0,)):
            budget.use(now, (600.0,))
            sent.append(now)
    longer = 600.0 / (250.0 * (1.0 - TUNING.beside_oversized) - 50.0)
    assert len(sent) == math.floor(20.0 / longer) + 1
    assert all(later - earlier >= longer for earlier, later in itertools.pairwise(sent))


def test_large_sends_are_forgotten_as_all_others_are(make_budget):
    """Ours and those of others, however many there were."""
    budget, view = make_budget()
    for number in range(500):
        heard(view, float(number), 600)
        view.sweep(float(number))
        budget.use(float(number), (600.0,))
        assert budget.lacking(float(number), (300.0,))
    assert len(budget.own.bulky) <= 2 * TUNING.stretched_windows
    assert len(budget._others.bulky(0.0, budget.limits)) < 5


def test_under_other_limits_nothing_is_stretched_that_was(make_budget):
    """Until it is weighed what competes for these: limits have other places then."""
    budget, _ = make_budget()
    budget.stretch.weigh(budget.limits, (0.0,), [((1500.0,), (0.0,))])
    assert budget.problem_limits(1.0).windows[0] > 1.0
    budget.set_limits((COUNT, BYTES))
    assert budget.problem_limits(1.0).windows == (1.0, 1.0)
    assert budget.free(1.0) == [COUNT.limit, BYTES.limit]


def test_what_was_sent_under_a_larger_limit_counts_as_the_part_that_it_was_and_stretches_no_window(make_budget):
    """Ours and others': nothing is held up for many windows by frames that the limit before had room for."""
    budget, view = make_budget(BYTES, COUNT)
    for number in range(10):
        budget.use(0.5 * number, (220.0, 1.0))
        heard(view, 0.5 * number + 0.1, 220)
    smaller = replace(BYTES, limit=100.0, measure=Throughput(100.0, 1.0))
    budget.set_limits((smaller, COUNT), 5.0)
    budget.stretch.weigh(budget.limits, (20.0, 0.0), [((450.0, 1.0), (0.0, 0.0))])
    assert budget.free(4.9, (30.0, 1.0)) == pytest.approx([12.0, 2.0])
    assert 4.9 < budget.opens(4.9, (30.0, 1.0), anybodys=True) < 5.4
    assert not budget.lacking(5.4, (30.0, 1.0))
    limits = budget.problem_limits(5.7)
    assert limits.windows[0] > 4.0
    assert {use[0] for _, use in (*limits.sent, *limits.others)} == {22.0}
    budget.use(5.7, (450.0, 1.0))
    assert budget.lacking(9.0, (90.0, 1.0)), "what is sent from then on counts whole"


@pytest.mark.parametrize(
    ("before", "after", "counts"),
    [
        (BYTES, replace(BYTES, limit=4000.0, measure=Throughput(4000.0, 1.0)), 600.0),
        (BYTES, Limit("bytes", 4.0, 2000.0, Throughput(2000.0, 4.0)), 300.0),
        (Limit("bytes", 4.0, 4000.0, Throughput(4000.0, 4.0)), BYTES, 150.0),
        (COUNT, BYTES, 0.0),
    ],
    ids=["more", "a smaller rate", "a shorter window", "new"],
)
def test_what_was_sent_counts_as_the_part_of_room_and_rate_that_it_was(make_budget, before, after, counts):
    """And never for more than it is; what one more change leaves of that, if limits change again."""
    budget, view = make_budget(before)
    budget.use(1.0, (600.0,))
    heard(view, 1.1, 600)
    budget.set_limits((after,), 1.5)
    assert [use for _, use in budget.own] == [use for _, use in budget.others(1.5)] == [(counts,)]
    budget.set_limits((replace(after, limit=0.5 * after.limit, measure=Throughput(0.5, 1.0)),), 1.6)
    assert [use for _, use in budget.own] == [use for _, use in budget.others(1.6)] == [(0.5 * counts,)]
    heard(view, 1.7, 600)
    assert [use for t, use in budget.others(1.7) if t > 1.6] == [(600.0,)]


def test_a_limit_that_follows_the_channel_is_no_other_one(make_budget):
    """What was sent before it became less goes on to count in stretched windows."""
    budget, _ = make_budget()
    budget.use(1.0, (900.0,))
    budget.set_limits((replace(BYTES, limit=100.0),), 1.5)
    budget.stretch.weigh(budget.limits, (0.0,), [((450.0,), (0.0,))])
    assert budget.lacking(4.0, (450.0,))


def test_what_is_sent_beside_a_large_message_keeps_the_limit_alone(make_budget):
    """A window of sixteen has room for much, that of the limit has not."""
    budget, view = make_budget()
    heard(view, 1.0, 2500)
    heard(view, 1.0, 5000)
    assert budget.lacking(4.0, (700.0,))
    assert not budget.lacking(6.0, (700.0,))
    budget.use(6.0, (700.0,))
    heard(view, 6.1, 200)
    assert budget.lacking(6.5, (101.0,))
    assert not budget.lacking(6.5, (99.0,))
    assert budget.opens(6.5, (101.0,)) == pytest.approx(7.0, abs=1e-5), "when what was sent beside has left"
    assert budget.opens(6.5, (99.0,)) == -math.inf


def test_a_message_that_does_not_fit_beside_what_is_sent_is_one_too_large_for_the_window(make_budget):
    """Though the empty limit would hold it: it was never sent. Where some of its stream do fit these are."""
    budget, _ = make_budget()
    for number in range(10):
        budget.use(0.1 * number, (5.0,))
    for deviation, fits in ((0.0, True), (40.0, False)):
        budget.stretch.weigh(budget.limits, (50.0,), [((980.0,), (deviation,))], (50.0,))
        assert bool(budget.lacking(1.0, (980.0,), (1030.0,))) == (not fits)


def test_no_window_is_stretched_for_what_is_not_bulky(make_budget):
    """A message of 6 % beside small ones that use 95: others would not know that it counts in 16 windows."""
    budget, _ = make_budget()
    for number in range(19):
        budget.use(0.05 * number, (50.0,))
    budget.stretch.weigh(budget.limits, (950.0,), [((60.0,), (0.0,))], (950.0,))
    assert budget.lacking(0.95, (60.0,))


def test_what_messages_use_together_is_no_message_larger_than_the_limit(make_budget):
    """For one that is smaller a window must be empty that is as much longer: each may be what another robot sends."""
    budget, _ = make_budget()
    budget.use(3.9, (20.0,))
    assert not budget.lacking(4.0, (600.0,), (900.0,))
    assert budget.lacking(4.0, (600.0,), (1200.0,))
    assert not budget.lacking(5.2, (600.0,), (1200.0,))


def test_windows_are_stretched_no_further_than_sends_are_remembered(make_budget):
    """A message of a thousand limits goes after so many windows."""
    budget, _ = make_budget()
    budget.use(0.0, (1.0,))
    assert budget.lacking(0.5 * TUNING.stretched_windows, (1e6,))
    assert not budget.lacking(TUNING.stretched_windows + 0.1, (1e6,))
