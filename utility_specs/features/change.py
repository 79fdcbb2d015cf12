"""How much an image differs from the one before: `{ kind = "change" }`."""

from collections import OrderedDict
from dataclasses import dataclass, field
from typing import Literal

from utility_specs.features.feature import Feature
from utility_specs.features.image import Image, ImageTable
from utility_specs.features.pixels import Pixels, opencv
from utility_specs.features.sample import Sample

GRID = (64, 48)
"""Width and height to which images are made small before they are compared."""

STREAMS = 256
"""Streams whose last image is remembered, of each feature: 3 kB each."""


@dataclass(frozen=True, slots=True)
class Change(Feature):
    """The mean absolute difference of lightness to the last image of the stream, from 0 to 1.

    Of a stream's first image it is the default: nothing is known of what it changed.
    """

    image: Image = field(default_factory=Image)
    _last: OrderedDict[str, Pixels] = field(default_factory=OrderedDict, init=False, repr=False, compare=False)

    def compares(self, key: str) -> bool:
        """Whether there is an image of the stream to compare the next one with."""
        return key in self._last

    def measure(self, sample: Sample) -> float:
        """Return the change, and remember the image; raises FeatureError when there is none."""
        cv2, _ = opencv()
        now = cv2.resize(self.image.grey(sample), GRID, interpolation=cv2.INTER_AREA)
        before = self._last.pop(sample.key, None)
        self._last[sample.key] = now
        if len(self._last) > STREAMS:
            self._last.popitem(last=False)
        return self.default if before is None else float(cv2.absdiff(now, before).mean()) / 255.0


class ChangeTable(ImageTable):
    """`{ kind = "change" }`: the mean absolute difference to the last image of the stream, from 0 to 1."""

    kind: Literal["change"]

    def feature(self) -> Change:
        """Return the feature that the table describes."""
        return Change(self.image(), default=self.default, budget=self.budget)
