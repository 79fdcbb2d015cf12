"""The workloads of real traffic."""

import pytest

from studies.simulation.missions import specs_of
from studies.simulation.traffic.workloads import MBIT, WORKLOADS, cameras, crowd, mixed, random


@pytest.mark.parametrize("name", WORKLOADS)
def test_an_operator_can_write_their_specs(name):
    """One information type for each kind, and the limit."""
    workload = WORKLOADS[name](4)
    specs = specs_of(workload.spec())
    assert [each.name for each in specs.types] == [kind.name for kind in workload.kinds]
    (limit,) = specs.constraints
    assert limit.measure.limit == pytest.approx(workload.rate * workload.window)
    assert limit.measure.window == workload.window


def test_small_samples_are_a_few_percent_of_the_limit():
    """What each robot of *mixed* says besides images; alarms are the most urgent and the rarest."""
    small = [kind for kind in mixed(4).robots[0] if kind.small]
    used = sum(kind.rates[0] * sum(kind.sizes) / 2 for kind in small)
    assert used == pytest.approx(0.03 * MBIT, rel=0.1)
    (alarm,) = (kind for kind in small if kind.alarm)
    assert alarm.weight == max(kind.weight for kind in small)
    assert alarm.rates[0] == min(kind.rates[0] for kind in small)


def test_every_robot_has_its_traffic():
    """Robots of *random* differ in weight, those of the others do not differ."""
    assert [own[0].weight for own in random(7).robots] == [1, 2, 4, 8, 16, 1, 2]
    assert len(random(7).kinds) == 5
    assert (len(cameras(8).robots), len(cameras(8).kinds)) == (8, 1)
    assert [len(own) for own in crowd(50).robots] == [5] * 50
