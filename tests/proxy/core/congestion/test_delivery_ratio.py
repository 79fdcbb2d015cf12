"""Only loss beyond the usual counts."""

import random

import pytest

from proxy.core.congestion.evidence import DeliveryRatio
from proxy.core.congestion.tuning import TUNING


def flown(parts, *, every=0.5, rate=50, seed=0):
    """What was lost after each report of a flight in which such parts arrive."""
    delivery, dice = DeliveryRatio(), random.Random(seed)
    sent = arrived = 0
    losses = []
    for i, part in enumerate(parts):
        sent += rate
        arrived += sum(dice.random() < part for _ in range(rate))
        delivery.note(i * every, sent, "op", arrived)
        losses.append(delivery.excess_loss(i * every))
    return delivery, losses


@pytest.mark.parametrize("part", [1.0, 0.95, 0.7, 2.0])
def test_a_radio_that_always_loses_is_no_full_channel(part):
    """Nor does it matter how many of the others count what they hear."""
    _, losses = flown([part] * 100)
    assert max(losses) < TUNING.excess_loss


def test_more_loss_than_usual_is_seen_within_seconds():
    """And forgotten once it is usual, or accepted."""
    delivery, losses = flown([0.95] * 30 + [0.4] * 10)
    assert max(losses[:30]) < TUNING.excess_loss < losses[-1]
    delivery.accept()
    assert delivery.excess_loss(20.0) == 0.0
    assert flown([0.95] * 30 + [0.4] * 100)[1][-1] < TUNING.excess_loss


def test_who_left_or_restarted_makes_counts_incomparable():
    """Nothing is known then, nor after silence, nor where nothing ever arrives."""
    delivery, _ = flown([0.95] * 30 + [0.4] * 10)
    assert delivery.excess_loss(19.5) > TUNING.excess_loss
    assert delivery.excess_loss(60.0) == 0.0
    delivery.note(20.0, 2050, "op", 0)
    assert delivery.excess_loss(20.0) == 0.0
    delivery.forget("nobody")
    assert flown([0.0] * 20)[1][-1] == 0.0
