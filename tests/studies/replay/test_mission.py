"""Specs and limits for recorded traffic."""

import pytest

from studies.replay.mission import RATE, Mission, features_of, lacking, utility_of, with_limit, worth_key
from studies.replay.samples import Sample
from studies.simulation.missions import specs_of
from tests.studies.replay.traffic import mission, spec

ENERGY = '[[constraint]]\nkind = "energy"\nlimit = "1 J"\nper_byte = "1 mJ"\n'


def test_another_limit_takes_the_place_of_the_throughput():
    """In the same windows; other constraints stay, and without one it comes in addition."""
    other = with_limit(mission().specs, 500.0)
    (only,) = other.constraints
    assert (only.measure.limit, only.measure.window) == (500.0, 1.0)
    assert other.generation != mission().specs.generation
    without = specs_of(ENERGY + spec()[spec().index("[[information") :])
    assert [each.measure.kind for each in with_limit(without, 500.0).constraints] == ["throughput", "energy"]


def test_each_robot_has_a_battery_of_its_own():
    """What one sends takes nothing of the others'."""
    flown = mission(ENERGY + spec(), ("r1", "r2"))
    assert [limit.robot for limit in flown.limits] == [None, 0, 1]
    assert flown.use(100, 1) == (100.0, 0.0, pytest.approx(0.1))


def test_the_medium_is_faster_than_any_limit():
    """And the operator has a name of its own."""
    assert mission().rate == RATE
    assert Mission(with_limit(mission().specs, 1e9), ("r1",)).rate == 1e10
    assert Mission(mission().specs, ("operator",)).operator == "operator-"


def test_features_come_from_the_payload_or_from_the_recording():
    """Else they have their defaults, which is told."""
    text = spec() + '[[information_type]]\nname = "t"\nkeys = ["*/t"]\nutility = { kind = "video" }\n'
    text += 'features.n = { kind = "key_chunk", index = 0 }\nfeatures.size = { kind = "size" }\n'
    specs = specs_of(text)
    camera, other = specs.types
    sample = Sample("r1", "r1/camera", 0.0, 0.0, 9, {"red": 0.25, "blue": 1.0})
    assert features_of(camera, sample) == {"red": 0.25}
    seen = Sample("r1", "r1/camera", 0.0, 0.0, 9, {"red": 0.25}, payload=b'{"red": 0.75}')
    assert features_of(camera, seen) == {"red": 0.75}
    assert lacking(camera, seen) == []
    none = Sample("r7", "7/t", 0.0, 0.0, 9)
    assert features_of(camera, none) == {"red": 0.5}
    assert lacking(camera, none) == ["red"]
    assert features_of(other, none) == {"n": 7.0, "size": 9.0}
    assert lacking(other, none) == []


def test_only_a_utility_that_knows_features_differs_from_sample_to_sample():
    """Others are the same for all of a stream."""
    camera, *_ = mission().specs.types
    assert worth_key(camera, {"red": 1.0}) == ()
    assert utility_of(camera, ()) is camera.utility
