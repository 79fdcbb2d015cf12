"""How sharp images are."""

import cv2
import numpy as np

from tests.utility_specs.features import scenes
from utility_specs.features.image import Image
from utility_specs.features.sample import Sample
from utility_specs.features.sharpness import Sharpness, SharpnessTable


def test_the_variance_of_the_laplacian():
    """Of a single light pixel on black, in all of its values."""
    image = np.zeros((10, 10, 3), np.uint8)
    image[5, 5] = 100
    laplacian = np.zeros(100)
    laplacian[:5] = (-400, 100, 100, 100, 100)
    found = Sharpness(Image(reduction=1)).measure(Sample("k", scenes.encoded(image)))
    assert found == np.float32(laplacian.var())


def test_what_is_blurred_is_less_sharp():
    """The more, the less; where nothing is seen it is 0."""
    board = scenes.checked(60, 200, squares=40)
    blurred = [board, *(cv2.GaussianBlur(board, (0, 0), sigma) for sigma in (1, 2, 4, 8))]
    found = [Sharpness().measure(Sample("k", scenes.encoded(image, ".jpg"))) for image in blurred]
    assert found == sorted(found, reverse=True)
    assert found[0] > 2 * found[2] > 4 * found[3]
    assert Sharpness().measure(Sample("k", scenes.encoded(np.full((48, 64, 3), 90, np.uint8)))) == 0.0


def test_its_table_gives_the_feature():
    """What all features may set is taken over."""
    assert SharpnessTable(kind="sharpness", default=9.0).feature() == Sharpness(default=9.0)
