"""How large a sample is: `{ kind = "size" }`."""

from dataclasses import dataclass
from typing import Literal

from utility_specs.features.feature import Feature, FeatureTable
from utility_specs.features.sample import Sample


@dataclass(frozen=True, slots=True)
class Size(Feature):
    """The length of the payload [B]."""

    def measure(self, sample: Sample) -> float:
        """Return the payload's length [B]."""
        return float(len(sample.payload))


class SizeTable(FeatureTable):
    """`{ kind = "size" }`: the length of the payload [B]."""

    kind: Literal["size"]

    def feature(self) -> Size:
        """Return the feature that the table describes."""
        return Size(default=self.default, budget=self.budget)
