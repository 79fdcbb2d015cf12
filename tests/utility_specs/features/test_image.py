"""Where images are in payloads, and that each is decoded once."""

import numpy as np
import pytest
from pydantic import ValidationError

from tests.utility_specs.features import scenes
from utility_specs.features.brightness import BrightnessTable
from utility_specs.features.color_fraction import ColorFractionTable
from utility_specs.features.image import Image
from utility_specs.features.sample import Sample

BOARD = scenes.checked(64, 192)
RAW = {"width": 640, "height": 480, "encoding": "rgb8"}
PAYLOADS = {
    "compressed": (scenes.encoded(BOARD, ".jpg"), {}),
    "raw": (BOARD.tobytes(), RAW),
    "sensor_msgs/msg/Image": (scenes.ros_image(BOARD), {}),
    "sensor_msgs/msg/CompressedImage": (scenes.ros_compressed(scenes.encoded(BOARD, ".jpg")), {}),
}


@pytest.mark.parametrize("form", PAYLOADS)
@pytest.mark.parametrize("downscale", [1, 4])
def test_the_same_image_in_every_form_gives_the_same_value(form, downscale):
    """A chessboard of 64 and 192 is half light."""
    payload, said = PAYLOADS[form]
    table = BrightnessTable(kind="brightness", format=form, downscale=downscale, **said)
    assert abs(table.feature().measure(Sample("k", payload)) - 128 / 255) < 0.003


def test_features_of_one_image_decode_it_once():
    """If they look at it in the same way."""
    sample = Sample("k", PAYLOADS["compressed"][0])
    features = [
        BrightnessTable(kind="brightness").feature(),
        ColorFractionTable(kind="color_fraction", color="red").feature(),
    ]
    for feature in features:
        feature.measure(sample)
    assert features[0].image.pixels(sample) is features[1].image.pixels(sample)
    assert Image(reduction=1).pixels(sample) is not features[0].image.pixels(sample)


def test_a_grey_image_has_no_colours():
    """Its three colours are alike."""
    sample = Sample("k", np.full((8, 8), 90, np.uint8).tobytes())
    image = Image("raw", 8, 8, "mono8", 1)
    assert image.grey(sample).shape == (8, 8)
    assert (image.color(sample) == 90).all()
    assert image.color(sample).shape == (8, 8, 3)


@pytest.mark.parametrize(
    ("said", "message"),
    [
        ({"format": "raw", "width": 640, "height": 480}, 'format = "raw" needs width, height and encoding'),
        ({"width": 640}, 'width has a meaning only with format = "raw"'),
        ({"format": "raw", **RAW, "encoding": "rgb"}, r'unknown encoding "rgb" \(did you mean "rgb8"\?\)'),
        ({"format": "raw", **RAW, "width": 65536, "height": 65536}, "an image has at most 33554432 pixels"),
        (
            {"format": "raw", **RAW, "width": 641, "encoding": "uyvy"},
            "no uyvy image has 641 x 480 pixels: its sides must be even",
        ),
        (
            {"format": "raw", **RAW, "height": 481, "encoding": "nv12"},
            "no nv12 image has 640 x 481 pixels: its sides must be even",
        ),
        ({"downscale": 3}, "Input should be 1, 2, 4 or 8"),
        ({"format": "jpeg"}, "Input should be 'compressed'"),
    ],
)
def test_an_image_that_is_not_described_is_refused(said, message):
    """When the spec is loaded."""
    with pytest.raises(ValidationError, match=message):
        BrightnessTable(kind="brightness", **said)


@pytest.mark.parametrize("payload", [b"no image", b"", b"\xff\xd8\xff"])
def test_what_is_no_image_has_no_pixels(payload):
    """Whether OpenCV says so or we."""
    with pytest.raises(ValueError, match="the payload is not an image"):
        Image().pixels(Sample("k", payload))
