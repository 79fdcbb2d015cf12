"""Only loss beyond the usual counts."""

import random

import pytest

from proxy.core.congestion.delivery_ratio import LOST, Arrivals


def flown(parts, *, every=0.5, rate=50, seed=0):
    """What was lost after each report of a flight in which such parts arrive."""
    arrivals, dice = Arrivals(), random.Random(seed)
    sent = arrived = 0
    told = []
    for i, part in enumerate(parts):
        sent += rate
        arrived += sum(dice.random() < part for _ in range(rate))
        arrivals.note(i * every, sent, "op", arrived)
        told.append(arrivals.lost(i * every))
    return arrivals, told


@pytest.mark.parametrize("part", [1.0, 0.95, 0.7, 2.0])
def test_a_radio_that_always_loses_is_no_full_channel(part):
    """Nor does it matter how many of the others count what they hear."""
    _, told = flown([part] * 100)
    assert max(told) < LOST


def test_more_loss_than_usual_is_seen_within_seconds():
    """And forgotten once it is usual, or accepted."""
    arrivals, told = flown([0.95] * 30 + [0.4] * 10)
    assert max(told[:30]) < LOST < told[-1]
    arrivals.accept()
    assert arrivals.lost(20.0) == 0.0
    assert flown([0.95] * 30 + [0.4] * 100)[1][-1] < LOST


def test_who_left_or_restarted_makes_counts_incomparable():
    """Nothing is known then, nor after silence, nor where nothing ever arrives."""
    arrivals, _ = flown([0.95] * 30 + [0.4] * 10)
    assert arrivals.lost(19.5) > LOST
    assert arrivals.lost(60.0) == 0.0
    arrivals.note(20.0, 2050, "op", 0)
    assert arrivals.lost(20.0) == 0.0
    arrivals.forget("nobody")
    assert flown([0.0] * 20)[1][-1] == 0.0
