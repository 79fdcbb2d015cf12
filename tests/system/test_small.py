"""The benchmark of a small computer, whose daemon the kernel holds to a part of a core."""

import pytest

from proxy.config import PlannerConfig
from proxy.config_loading import load_config
from studies.benchmarks.small import PROFILE, measure_small

pytestmark = pytest.mark.system


def test_a_daemon_is_held_to_a_part_of_a_core():
    """Samples are decided on there, too, as it comes and with the shipped profile."""
    (table,) = measure_small(quick=True)
    assert len(table.rows) == 3
    for _, part, samples, searches, *_ in table.rows:
        assert 0 < int(part.rstrip("%")) <= 110
        assert float(samples) > 20.0
        assert int(searches) > 0


def test_the_profile_is_a_configuration():
    """Which may be laid upon any other."""
    laid_on = load_config(PROFILE, {}, {}).planner
    assert laid_on.iterations < PlannerConfig().iterations
    assert laid_on.horizon < PlannerConfig().horizon
