"""When nobody waits for an agreement any more."""

from proxy.core.coordination.patience import Patience
from proxy.core.coordination.tuning import TUNING

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
