"""How much of an image has a colour: `{ kind = "color_fraction", color = "red" }` (`m.red` of Eq. 9)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from pydantic import Field

from utility_specs.features.feature import Feature
from utility_specs.features.image import Image, ImageTable
from utility_specs.features.pixels import opencv
from utility_specs.features.sample import Sample

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


@dataclass(frozen=True, slots=True)
class ColorFraction(Feature):
    """The share of pixels of a colour, from 0 to 1."""

    color: Color
    image: Image = field(default_factory=Image)

    def measure(self, sample: Sample) -> float:
        """Return the fraction; raises FeatureError when there is no image."""
        cv2, _ = opencv()
        hsv = cv2.cvtColor(self.image.color(sample), cv2.COLOR_BGR2HSV)
        colored = sum(
            cv2.countNonZero(cv2.inRange(hsv, (low, LEAST_SATURATION, LEAST_VALUE), (high, 255, 255)))
            for low, high in HUES[self.color]
        )
        return float(colored / (hsv.shape[0] * hsv.shape[1]))


class ColorFractionTable(ImageTable):
    """`{ kind = "color_fraction", color = … }`: the share of an image's pixels that have a colour, from 0 to 1."""

    kind: Literal["color_fraction"]
    color: Color = Field(description="Which colour.")

    def feature(self) -> ColorFraction:
        """Return the feature that the table describes."""
        return ColorFraction(self.color, self.image(), default=self.default, budget=self.budget)
