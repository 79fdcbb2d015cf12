"""How light images are."""

import numpy as np
import pytest

from tests.utility_specs.features import scenes
from utility_specs.features.brightness import Brightness, BrightnessTable
from utility_specs.features.sample import Sample


@pytest.mark.parametrize("grey", [0, 51, 128, 255])
def test_a_grey_image_is_as_light_as_its_grey(grey):
    """From 0 to 1."""
    payload = scenes.encoded(np.full((48, 64, 3), grey, np.uint8))
    assert Brightness().measure(Sample("k", payload)) == grey / 255


def test_colours_count_as_eyes_see_them():
    """Green is lighter than red, and red than blue."""
    found = []
    for channel in (1, 2, 0):
        image = np.zeros((48, 64, 3), np.uint8)
        image[:, :, channel] = 255
        found.append(Brightness().measure(Sample("k", scenes.encoded(image))))
    assert found == [150 / 255, 76 / 255, 29 / 255]


def test_its_table_gives_the_feature():
    """What all features may set is taken over."""
    table = BrightnessTable(kind="brightness", default=0.5, budget="3 ms")
    assert table.feature() == Brightness(default=0.5, budget=0.003)
