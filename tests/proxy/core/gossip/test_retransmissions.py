"""What was announced is sent again where many miss it."""

import math

import pytest

from proxy.core.gossip.retransmissions import Retransmissions
from proxy.core.gossip.tuning import TUNING
from proxy.core.protocol.messages import Digest

AFTER = TUNING.retransmit_after
MOST = TUNING.retransmissions


def sent(again, until=10.0):
    """When it was sent again until then, and what."""
    found = []
    while again.due_at <= until:
        found.append((again.due_at, again.take(again.due_at)))
    return found


@pytest.mark.parametrize(("lost", "times"), [(0.0, 0), (0.01, 0), (0.05, 0), (0.1, 1), (0.3, 3), (0.9, MOST)])
def test_it_is_told_until_few_have_missed_it(lost, times):
    """The sample itself and the announcement are two of the times."""
    again = Retransmissions()
    again.announced(Digest("r1", "z", 1.0, state=7, brief=True), lost)
    found = sent(again)
    assert len(found) == times
    assert times == MOST or lost ** (2 + times) <= TUNING.missed
    assert all(digest == Digest("r1", "z", at, state=7, brief=True) for at, digest in found)
    assert again.due_at == math.inf


def test_each_time_comes_later_than_the_one_before():
    """What is lost in a row is lost together."""
    again = Retransmissions()
    again.announced(Digest("r1", "z", 1.0), 0.5)
    times = [at for at, _ in sent(again)]
    assert times == pytest.approx([1.0 + AFTER, 1.0 + 3 * AFTER, 1.0 + 7 * AFTER])


def test_nothing_is_told_before_it_is_due_and_the_newest_takes_the_place_of_the_last():
    """Both count from when they were announced."""
    again = Retransmissions()
    assert again.take(5.0) is None
    again.announced(Digest("r1", "z", 1.0, state=1), 0.3)
    assert again.take(1.0 + 0.5 * AFTER) is None
    again.announced(Digest("r1", "z", 2.0, state=2), 0.1)
    assert [digest.state for _, digest in sent(again)] == [2]
