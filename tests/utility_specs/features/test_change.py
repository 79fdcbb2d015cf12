"""How much images differ from those before."""

import numpy as np
import pytest

from tests.utility_specs.features import scenes
from utility_specs.errors import FeatureError
from utility_specs.features import change
from utility_specs.features.change import Change, ChangeTable
from utility_specs.features.sample import Sample


def grey(value, key="k", size=(48, 64)):
    return Sample(key, scenes.encoded(np.full((*size, 3), value, np.uint8)))


def test_the_mean_difference_to_the_image_before():
    """From 0 to 1, either way; of the first image it is the default."""
    feature = Change(default=0.7)
    assert [feature.measure(grey(value)) for value in (0, 51, 51, 0, 255)] == [0.7, 0.2, 0.0, 0.2, 1.0]


def test_what_moves_counts_by_its_area():
    """A quarter of the image from black to white."""
    feature, image = Change(), np.zeros((480, 640, 3), np.uint8)
    feature.measure(Sample("k", scenes.encoded(image)))
    image[:240, :320] = 255
    assert feature.measure(Sample("k", scenes.encoded(image))) == 0.25


def test_each_stream_has_its_own_last_image():
    """Whatever the size of the images."""
    feature = Change()
    for key, value in (("a", 0), ("b", 255)):
        feature.measure(grey(value, key))
    assert feature.measure(grey(51, "a", (96, 200))) == 0.2
    assert feature.measure(grey(255, "b")) == 0.0


def test_a_broken_image_leaves_the_last_one():
    """The next one is compared with that."""
    feature = Change()
    feature.measure(grey(0))
    with pytest.raises(FeatureError):
        feature.measure(Sample("k", b"broken"))
    assert feature.measure(grey(51)) == 0.2


def test_streams_are_bounded(monkeypatch):
    """Those that were silent longest are forgotten."""
    monkeypatch.setattr(change, "STREAMS", 2)
    feature = Change(default=-1.0)
    for key in ("a", "b", "a", "c"):
        feature.measure(grey(0, key))
    assert [feature.measure(grey(51, key)) for key in ("a", "b")] == [0.2, -1.0]


def test_its_table_gives_the_feature():
    """With no past."""
    assert ChangeTable(kind="change", default=1.0).feature() == Change(default=1.0)
