"""The fraction of an image that has a colour."""

from typing import get_args

import cv2
import numpy as np
import pytest

from utility_specs.errors import FeatureError
from utility_specs.features.color_fraction import HUES, Color, ColorFraction, ColorFractionTable
from utility_specs.features.sample import Sample

BGR = {
    "red": (30, 20, 200),
    "orange": (10, 130, 250),
    "yellow": (30, 220, 230),
    "green": (40, 180, 40),
    "cyan": (220, 200, 30),
    "blue": (220, 60, 20),
    "magenta": (200, 30, 190),
}


def scene(color: tuple[int, int, int], fraction: float) -> tuple[np.ndarray, float]:
    """Draw a rectangle on grey texture, 640 x 480; return the image and the fraction really covered."""
    noise = np.random.default_rng(1).integers(60, 200, (480, 640, 1), dtype=np.uint8).repeat(3, axis=2)
    image = cv2.GaussianBlur(noise, (0, 0), 2.0)
    height, width = round(480 * fraction**0.5), round(640 * fraction**0.5)
    image[10 : 10 + height, 5 : 5 + width] = color
    painted = image[10 : 10 + height, 5 : 5 + width]
    return image, painted.shape[0] * painted.shape[1] / (480 * 640)


def encoded(image: np.ndarray, form: str = ".jpg", quality: int = 80) -> bytes:
    return cv2.imencode(form, image, [cv2.IMWRITE_JPEG_QUALITY, quality] if form == ".jpg" else [])[1].tobytes()


@pytest.mark.parametrize("fraction", [0.0, 0.03, 0.2, 0.35, 0.8])
@pytest.mark.parametrize("quality", [40, 80, 95])
def test_the_red_fraction_of_a_jpeg_is_right_within_two_percent(fraction, quality):
    """Whatever the size of the red object and the quality of the image."""
    image, truth = scene(BGR["red"], fraction)
    assert abs(ColorFraction("red").measure(Sample("k", encoded(image, quality=quality))) - truth) < 0.02


@pytest.mark.parametrize("color", BGR)
def test_each_colour_is_told_from_the_others(color):
    """A painted colour is found, and no other."""
    image, truth = scene(BGR[color], 0.3)
    found = {each: ColorFraction(each).measure(Sample("k", encoded(image, ".png"))) for each in BGR}
    assert abs(found.pop(color) - truth) < 0.02
    assert max(found.values()) < 0.01


def test_hues_cover_the_circle_once():
    """Every hue has exactly one colour."""
    hues = [hue for ranges in HUES.values() for low, high in ranges for hue in range(low, high + 1)]
    assert sorted(hues) == list(range(180))
    assert set(HUES) == set(get_args(Color)) == set(BGR)


@pytest.mark.parametrize("value", [0, 20, 128, 255])
def test_grey_black_and_white_have_no_colour(value):
    """Pixels without saturation or light count for nothing."""
    image = encoded(np.full((48, 64, 3), value, np.uint8))
    assert sum(ColorFraction(color).measure(Sample("k", image)) for color in BGR) == 0.0


@pytest.mark.parametrize("payload", [b"", b"x", b"\xff\xd8\xff", b'{"red": 1}'])
def test_what_is_not_an_image_has_no_value(payload):
    """The caller then takes the default."""
    with pytest.raises(FeatureError):
        ColorFraction("red").measure(Sample("k", payload))


def test_its_table_gives_the_feature():
    """Colour and default are taken over."""
    feature = ColorFractionTable(kind="color_fraction", color="blue", default=0.1).feature()
    assert feature == ColorFraction("blue", default=0.1)
    assert feature.reads_payload
