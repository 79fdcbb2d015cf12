"""The ready-made spec of the paper's mission (Eq. 9)."""

import re
from importlib.resources import as_file, files

import pytest

from planner import Aggregation
from planner.airtime import Airtime
from planner.measures import Energy, Messages, Throughput
from planner.utility import Video
from utility_specs import Specs, load_specs


@pytest.fixture
def specs() -> Specs:
    with as_file(files("utility_specs") / "surveillance.toml") as path:
        return load_specs(path)


def test_it_is_eq_9(specs):
    """U_vid times 1 + 10 times the fraction of red, on 2 Mbit/s in windows of half a second."""
    camera = specs.match("robot/r1/camera")
    assert camera.utility == Video()
    assert camera.aggregation is Aggregation.CURRENT
    assert (camera.scale({"red": 0.0}), camera.scale({"red": 0.35}), camera.scale({"red": 1.0})) == (
        1.0,
        4.5,
        11.0,
    )
    assert [each.measure for each in specs.constraints] == [Throughput(250_000.0, 0.5)]


def test_it_survives_a_broken_image(specs):
    """A payload that is no image counts as one without red."""
    camera = specs.match("robot/r1/camera")
    assert camera.extract("robot/r1/camera", b"not a JPEG") == {"red": 0.0}
    assert camera.failures.counts() == {"red": 1}


def test_the_constraints_it_explains_can_be_switched_on(tmp_path):
    """Uncommented they load, and apart from the name and window they show the defaults."""
    text = (files("utility_specs") / "surveillance.toml").read_text()
    path = tmp_path / "surveillance.toml"
    path.write_text(re.sub(r"(?m)^#(?=\w|\[)", "", text))
    assert [(each.name, each.measure) for each in load_specs(path).constraints] == [
        ("throughput", Throughput(250_000.0)),
        ("pace", Messages(10)),
        ("airtime", Airtime(0.4, 6_750_000.0)),
        ("energy", Energy(0.5, 2.0, per_byte=2e-6, per_message=1e-3)),
    ]
