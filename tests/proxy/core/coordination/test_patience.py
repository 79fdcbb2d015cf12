"""When nobody waits for an agreement any more, nor for robots that say nothing of the parts that were agreed on."""

import pytest

from proxy.core.coordination.patience import Departed, Patience
from proxy.core.coordination.tuning import TUNING
from proxy.core.protocol.bid import UNIT, Segment
from proxy.core.protocol.messages import Digest
from proxy.core.protocol.split_report import SplitReport
from tests.proxy.core.split.agreeing import agree, robot

LONG = TUNING.agreement_time
REST = TUNING.retry_time


def test_it_lasts_while_nothing_is_pending_for_long():
    """What is pending again and again is not pending for long."""
    patience = Patience()
    for k in range(100):
        assert not patience.is_over(k * 0.5 * LONG, 0.0, pending=k % 2 == 0)


def test_late_news_are_given_more_time():
    """Where news take longer, so do agreements."""
    patience = Patience()
    assert not patience.is_over(0.0, 1.0, pending=True)
    assert not patience.is_over(LONG + TUNING.agreement_news - 0.1, 1.0, pending=True)
    assert patience.is_over(LONG + TUNING.agreement_news, 1.0, pending=True)


def test_what_was_agreed_on_before_goes_on_for_longer():
    """It is better than none."""
    patience = Patience()
    assert not patience.is_over(0.0, 0.0, pending=True, agreed=True)
    assert not patience.is_over(2.0 * LONG, 0.0, pending=True, agreed=True)
    assert patience.is_over(REST, 0.0, pending=True, agreed=True)


def test_each_attempt_in_vain_is_followed_by_a_longer_rest():
    """Up to a longest one; and an agreement makes it short again."""
    patience, now, rests = Patience(), 0.0, []
    for _ in range(8):
        patience.is_over(now, 0.0, pending=True)
        now += LONG
        assert patience.is_over(now, 0.0, pending=True)
        rests.append(rest(patience, now))
        now += rests[-1]
    assert rests == [min(REST * 2**k, TUNING.longest_retry) for k in range(8)]
    patience.is_over(now, 0.0, pending=True)
    patience.is_over(now, 0.0, pending=False)
    patience.is_over(now, 0.0, pending=True)
    assert patience.is_over(now + LONG, 0.0, pending=True)
    assert rest(patience, now + LONG) == REST


def rest(patience, now):
    """For how many seconds nobody waits from now on."""
    seconds = 0.0
    while patience.is_over(now + seconds, 0.0, pending=False):
        seconds += 1.0
    return seconds


REPORT = SplitReport(1, None, 7, 7, (), 0.0, 0)


def digest(tag, *, split=None, brief=False):
    return Digest("robot", tag, 0.0, split=split, brief=brief)


@pytest.fixture
def team():
    """Three robots that agreed on equal parts."""
    robots = robot("a", "bc"), robot("b", "ac"), robot("c", "ab")
    agree(0.1, *robots)
    return robots


def test_who_says_nothing_of_parts_any_more_has_departed_with_what_it_has(team):
    """Until it speaks of them again; an announcement says nothing of them anyway."""
    departed, own = Departed(), team[0]
    assert departed.share(digest("b", brief=True), own) == 0.0
    assert departed.share(digest("b"), own) == pytest.approx(own.log.agreed.allocation.parts["b"] / UNIT)
    assert departed.share(digest("c"), own) == pytest.approx((1.0 - 0.02) * 2 / 3, abs=1e-3)
    assert departed.share(digest("b", brief=True), own) == pytest.approx((1.0 - 0.02) * 2 / 3, abs=1e-3)
    assert departed.share(digest("b", split=REPORT), own) == pytest.approx((1.0 - 0.02) / 3, abs=1e-3)


def test_slots_that_it_holds_are_lost_with_it(team):
    """Its turn never ends."""
    large = (Segment(300, 200), Segment(6000, 120, 1), Segment(6000, 110, 1), Segment(6000, 100, 2))
    for each in team:
        each.ask(1.0, large)
    agree(1.1, *team)
    (turn,) = team[0].turns
    alone = team[0].log.agreed.allocation.parts
    for tag in ("b", "c"):
        turn.number = [each for each, _ in turn.slot.ring].index("c")
        held = turn.slot.size if tag == "c" else 0
        assert Departed().share(digest(tag), team[0]) == pytest.approx((held + alone[tag]) / UNIT)
    assert held > 0.5 * UNIT


def test_who_agreed_on_another_table_since_is_back(team):
    """And before anything is agreed on, or with strangers, nobody is missed."""
    departed = Departed()
    assert departed.share(digest("b"), robot("a", "b")) == 0.0
    assert departed.share(digest("stranger"), team[0]) == 0.0
    assert departed.share(digest("b"), team[0]) > 0.0
    team[1].ask(1.0, (Segment(5000, 120),))
    agree(1.1, *team)
    assert departed.share(digest("c", split=REPORT), team[0]) == 0.0
