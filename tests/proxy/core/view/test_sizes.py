"""The sizes of a stream's samples."""

import numpy as np
import pytest

from proxy.core.view.sizes import Sizes
from proxy.core.view.tuning import TUNING


@pytest.mark.parametrize("part", [0.05, 0.3, 0.9])
def test_the_smallest_samples_are_so_large_in_the_mean(part):
    """By sampling; never less than a part of the mean, for no size is negative."""
    drawn = np.sort(np.random.default_rng(3).normal(1000.0, 100.0, 200_000))
    assert Sizes(1000.0, 100.0**2).smallest(part) == pytest.approx(np.mean(drawn[: int(part * len(drawn))]), rel=0.01)
    assert Sizes(1000.0, 1000.0**2).smallest(0.05) == TUNING.smallest_size_part * 1000


def test_sizes_that_do_not_vary_are_planned_with_as_they_are():
    """And smaller ones than the mean where they do, but not much smaller."""
    sizes = Sizes()
    for _ in range(3):
        sizes.note(700)
    assert (sizes.mean, sizes.deviation, sizes.likely(700)) == (700.0, 0.0, 700)
    assert Sizes(1000.0, 100.0**2).likely(1200) == round(1000.0 - 100.0 * TUNING.sent_size_deviations)
    assert Sizes(1000.0, 9000.0**2).likely(1200) == 500


def test_mean_and_variance_follow_what_comes():
    """The recent sizes count more; who knows none takes the first one for the mean."""
    sizes, drawn = Sizes(), np.random.default_rng(5).normal(2000.0, 300.0, 400)
    for size in drawn:
        sizes.note(round(size))
    assert sizes.mean == pytest.approx(2000.0, rel=0.15)
    assert 100.0 < sizes.deviation < 500.0


def test_an_announced_size_is_kept_beside_what_is_seen():
    """All robots know that one alike."""
    sizes = Sizes()
    sizes.announce(512)
    sizes.note(700)
    assert (sizes.announced, sizes.mean) == (512, 700.0)
