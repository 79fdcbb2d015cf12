"""What the constraints of the specs leave for messages."""

import pytest

from planner.measures import Energy, Messages
from proxy.core.model.limits import allowance_of, limits_of, use_of
from tests.proxy.core.window.views import LIMIT
from utility_specs import ConstraintSpec, Specs


def test_digests_are_always_counted_against_the_limit(make_specs):
    """The larger of their share and 100 B/s per robot, but never nearly everything."""
    specs = make_specs(limit="80 kbit/s")
    assert limits_of(specs, 0.02, 1)[0].limit == pytest.approx(9_800.0)
    assert limits_of(specs, 0.02, 5)[0].limit == pytest.approx(9_500.0)
    assert limits_of(make_specs(limit="800 bit/s"), 0.02, 5)[0].limit == pytest.approx(10.0)
    assert allowance_of(specs, 0.05, 2) == 500.0
    assert allowance_of(specs, 0.02, 5) == 500.0


def test_every_copy_counts():
    """In unicast a sample costs a transmission per receiver."""
    assert use_of(100, 3, (LIMIT, LIMIT)) == (300.0, 300.0)


def kinds(*measures):
    """Specs of nothing but constraints."""
    return Specs((), tuple(ConstraintSpec(measure.kind, measure) for measure in measures), "")


def test_digests_count_by_every_measure():
    """So many bytes are at most so many digests of 64 B; of energy only our own digests take."""
    messages, energy = Messages(100, 1.0), Energy(1.0, 1.0, per_byte=1e-3)
    limits = limits_of(kinds(energy, messages), 0.0, 3)
    assert [limit.name for limit in limits] == ["messages", "energy"]
    assert limits[0].limit == pytest.approx(100 - 3 * 100 / (64 * 2))
    assert limits[1].limit == pytest.approx(1.0 - 100 * 1e-3)
    assert [limit.limit for limit in limits_of(kinds(messages), 0.1, 3)] == pytest.approx([90.0])
    assert allowance_of(kinds(messages), 0.06, 3) == pytest.approx(3 * 2 * 64 * 2)
    assert allowance_of(kinds(messages, energy), 0.5, 3) == pytest.approx(3 * 500.0)
