"""The ready-made spec of the paper's mission (Eq. 9)."""

from importlib.resources import as_file, files

import pytest

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
    assert (camera.scale({"red": 0.0}), camera.scale({"red": 0.35}), camera.scale({"red": 1.0})) == (
        1.0,
        4.5,
        11.0,
    )
    assert [(each.rate, each.window) for each in specs.constraints] == [(250_000.0, 0.5)]


def test_it_survives_a_broken_image(specs):
    """A payload that is no image counts as one without red."""
    camera = specs.match("robot/r1/camera")
    assert camera.extract("robot/r1/camera", b"not a JPEG") == {"red": 0.0}
    assert camera.failures.counts() == {"red": 1}
