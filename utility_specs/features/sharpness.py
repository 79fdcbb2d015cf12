"""How sharp an image is: `{ kind = "sharpness" }`."""

from dataclasses import dataclass, field
from typing import Literal

from utility_specs.features.feature import Feature
from utility_specs.features.image import Image, ImageTable
from utility_specs.features.pixels import opencv
from utility_specs.features.sample import Sample


@dataclass(frozen=True, slots=True)
class Sharpness(Feature):
    """The variance of the Laplacian of an image's lightness (0 to 255): 0 where nothing is seen, more the sharper."""

    image: Image = field(default_factory=Image)

    def measure(self, sample: Sample) -> float:
        """Return the sharpness; raises FeatureError when there is no image."""
        cv2, _ = opencv()
        return float(cv2.Laplacian(self.image.grey(sample), cv2.CV_32F).var())


class SharpnessTable(ImageTable):
    """`{ kind = "sharpness" }`: the variance of the Laplacian of an image."""

    kind: Literal["sharpness"]

    def feature(self) -> Sharpness:
        """Return the feature that the table describes."""
        return Sharpness(self.image(), default=self.default, budget=self.budget)
