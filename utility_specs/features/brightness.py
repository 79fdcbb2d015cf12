"""How light an image is: `{ kind = "brightness" }`."""

from dataclasses import dataclass, field
from typing import Literal

from utility_specs.features.feature import Feature
from utility_specs.features.image import Image, ImageTable
from utility_specs.features.sample import Sample


@dataclass(frozen=True, slots=True)
class Brightness(Feature):
    """The mean lightness of an image, from 0 (black) to 1 (white)."""

    image: Image = field(default_factory=Image)

    def measure(self, sample: Sample) -> float:
        """Return the brightness; raises FeatureError when there is no image."""
        return float(self.image.grey(sample).mean()) / 255.0


class BrightnessTable(ImageTable):
    """`{ kind = "brightness" }`: the mean lightness of an image, from 0 to 1."""

    kind: Literal["brightness"]

    def feature(self) -> Brightness:
        """Return the feature that the table describes."""
        return Brightness(self.image(), default=self.default, budget=self.budget)
