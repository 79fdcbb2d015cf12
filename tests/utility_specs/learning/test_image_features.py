"""What features find in images, for proposals."""

import pytest
from pydantic import TypeAdapter

from tests.utility_specs.features.scenes import checked, encoded, ros_compressed
from tests.utility_specs.learning.team import picture
from utility_specs.features import AnyFeatureTable, Sample
from utility_specs.learning.image_features import ImageFeatures, image_table
from utility_specs.toml_source import tomllib

COMPRESSED = "sensor_msgs/msg/CompressedImage"


def test_an_image_shows_colours_brightness_and_change():
    """The first one of a stream shows no change."""
    features = ImageFeatures(None)
    first, second = (features.of(Sample("k", picture(red))) for red in (0.5, 0.0))
    assert first["red"] == pytest.approx(0.5, abs=0.1)
    assert "change" not in first
    assert second["change"] > 0.05
    assert second["red"] == 0.0


def test_a_broken_image_shows_nothing():
    """And the next one is the first that shows anything."""
    features = ImageFeatures(None)
    assert features.of(Sample("k", b"\xff\xd8\xff")) == {}
    assert "change" not in features.of(Sample("k", picture(0.5)))


def test_images_of_ros_are_found_in_their_messages():
    """By the format that their tables say."""
    message = ros_compressed(encoded(checked(0, 255)))
    assert ImageFeatures(COMPRESSED).of(Sample("k", message))["brightness"] == pytest.approx(0.5, abs=0.05)


@pytest.mark.parametrize("ros", [None, COMPRESSED])
def test_each_has_a_table(ros):
    """As a spec has it."""
    for name in ImageFeatures(None).of(Sample("k", picture(0.5))):
        table = tomllib.loads(f"feature = {{ {image_table(name, ros)} }}")["feature"]
        assert TypeAdapter(AnyFeatureTable).validate_python(table)
        assert table.get("format") == ros
