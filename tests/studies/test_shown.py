"""What is shown too much, piece by piece."""

import numpy as np
import pytest

from studies.shown import excess


def test_it_lasts_from_the_end_of_an_event_to_the_next_receipt():
    """Red of scale 5 is received at 1 and over at 3; a plain frame comes at 4, and red that is there at 6."""
    shown = np.array([1.0, 4.0, 6.0]), np.array([5.0, 1.0, 5.0])
    generated = np.array([0.9, 3.0, 5.9]), np.array([5.0, 1.0, 5.0])
    begins, which, amount = excess(shown, generated, 8.0)
    assert amount.sum() == pytest.approx(4.0)
    assert [(b, w) for b, w, a in zip(begins, which, amount, strict=True) if a > 0] == [(3.0, 0)]


def test_it_is_cut_where_one_asks_for_it():
    """So that each piece lies within two cuts."""
    shown, generated = (np.array([0.0]), np.array([2.0])), (np.array([0.0, 1.0]), np.array([2.0, 0.5]))
    begins, _, amount = excess(shown, generated, 4.0, np.array([-1.0, 2.5, 9.0]))
    assert begins.tolist() == [0.0, 1.0, 2.5]
    assert amount.tolist() == [0.0, 1.5 * 1.5, 1.5 * 1.5]
