"""How much of an image has a colour: `{ kind = "color_fraction", color = "red" }` (`m.red` of Eq. 9)."""

import importlib
import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

from pydantic import Field

from utility_specs.errors import FeatureError
from utility_specs.features.feature import FeatureTable

Color = Literal["red", "orange", "yellow", "green", "cyan", "blue", "magenta"]

HUES: Mapping[Color, tuple[tuple[int, int], ...]] = {
    "red": ((0, 9), (171, 179)),
    "orange": ((10, 22),),
    "yellow": ((23, 35),),
    "green": ((36, 83),),
    "cyan": ((84, 98),),
    "blue": ((99, 130),),
    "magenta": ((131, 170),),
}
"""Ranges of hue, both ends included, on OpenCV's scale of 0 to 179; together they cover it."""

LEAST_SATURATION = 100
LEAST_VALUE = 60
"""Of 255; below, a pixel is grey or black and has no colour."""

LARGEST_IMAGE = 2**26
"""Pixels of the largest image that is decoded: a small payload may claim to be enormous."""


@dataclass(frozen=True, slots=True)
class ColorFraction:
    """The share of pixels of a colour, from 0 to 1, in a JPEG, PNG or any other image that OpenCV reads.

    The image is decoded at a quarter of its width and height, which for a JPEG also is much cheaper.
    """

    color: Color
    default: float = 0.0

    def __post_init__(self) -> None:
        _opencv()  # takes a while to import: at load time, not with the first sample

    @property
    def reads_payload(self) -> bool:
        """True: the image is the payload."""
        return True

    def measure(self, key: str, payload: bytes) -> float:
        """Return the fraction; raises FeatureError (or OpenCV's own error) for what is not an image."""
        cv2, numpy = _opencv()
        image = cv2.imdecode(numpy.frombuffer(payload, numpy.uint8), cv2.IMREAD_REDUCED_COLOR_4)
        if image is None:
            raise FeatureError(f"{key}: the payload is not an image")
        hsv = cv2.cvtColor(image, cv2.COLOR_BGR2HSV)
        colored = sum(
            cv2.countNonZero(cv2.inRange(hsv, (low, LEAST_SATURATION, LEAST_VALUE), (high, 255, 255)))
            for low, high in HUES[self.color]
        )
        return float(colored / (hsv.shape[0] * hsv.shape[1]))


class ColorFractionTable(FeatureTable):
    """`{ kind = "color_fraction", color = … }` in a spec."""

    kind: Literal["color_fraction"]
    color: Color = Field(description="Which colour.")

    def feature(self) -> ColorFraction:
        """Return the feature that the table describes."""
        return ColorFraction(self.color, self.default)


@cache
def _opencv() -> tuple[Any, Any]:
    """Return OpenCV and NumPy, imported when the first spec needs them."""
    os.environ.setdefault("OPENCV_IO_MAX_IMAGE_PIXELS", str(LARGEST_IMAGE))  # OpenCV reads it when it is imported
    return importlib.import_module("cv2"), importlib.import_module("numpy")
