"""What is seen of one stream: how much, how often, of what format, and the numbers in it."""

import math
from collections import Counter
from dataclasses import dataclass
from itertools import pairwise
from statistics import median
from typing import Protocol

from utility_specs.features import Sample
from utility_specs.learning.formats import Format, recognised, ros_type
from utility_specs.learning.image_features import ImageFeatures
from utility_specs.learning.leaves import Shown, Values, leaves
from utility_specs.learning.observed import Observed

MOST_LOOKS = 512
"""Samples of a stream that are looked into, spread over all of it."""


class Timing(Protocol):
    """Finds out how a stream generates."""

    def observe(self, count: int, t_gen: float) -> None:
        """Take in that sample number `count` was generated at `t_gen` [s]."""

    @property
    def kind(self) -> str:
        """`periodic`, `poisson`, `bursts` and more words; empty while not known."""

    @property
    def period(self) -> float:
        """Mean time between samples [s]; 0.0 while not known."""

    @property
    def jitter(self) -> float:
        """Standard deviation of a generation time from what is expected [s]."""


@dataclass(frozen=True, slots=True)
class Look:
    """What one sample showed: when [s], its size [B], its numbers and words."""

    time: float
    size: int
    format: Format
    values: Values


class Stream:
    """The samples of one key from one origin."""

    def __init__(self, key: str, timing: Timing) -> None:
        self.key = key
        self.timing = timing
        self.count = 0
        self.bytes = 0
        self.looks: list[Look] = []
        self._first = math.inf
        self._last = -math.inf
        self._stride = 1
        self._images: ImageFeatures | None = None

    def take(self, sample: Observed) -> None:
        """Take in the next sample."""
        self.count += 1
        self.bytes += sample.size
        self.timing.observe(self.count, sample.time)
        self._first, self._last = min(self._first, sample.time), max(self._last, sample.time)
        if (self.count - 1) % self._stride == 0:
            self.looks.append(self._look(sample))
        if len(self.looks) > MOST_LOOKS:
            self.looks = self.looks[::2]
            self._stride *= 2

    def _look(self, sample: Observed) -> Look:
        form, document = recognised(sample)
        if form in {"image", "ros_image"}:
            self._images = self._images or ImageFeatures(ros_type(sample.key) if form == "ros_image" else None)
            values = self._images.of(Sample(sample.key, sample.payload))
        else:
            values = {} if document is None else leaves(document)
        return Look(sample.time, sample.size, form, values)

    @property
    def interval(self) -> float:
        """Mean time between its samples [s]; 0.0 of a single one."""
        return (self._last - self._first) / (self.count - 1) if self.count > 1 else 0.0

    @property
    def gaps(self) -> list[float]:
        """Times from one sample looked into to the next [s]."""
        return [b.time - a.time for a, b in pairwise(self.looks)]

    @property
    def format(self) -> Format:
        """What most of its samples are."""
        return Counter(look.format for look in self.looks).most_common(1)[0][0]

    @property
    def sizes(self) -> list[int]:
        """Sizes of the samples looked into [B]."""
        return [look.size for look in self.looks]

    @property
    def size(self) -> float:
        """Median size [B]."""
        return median(self.sizes)

    @property
    def shows(self) -> tuple[Shown, ...]:
        """What its samples show, in their order."""
        return tuple(dict.fromkeys(shown for look in self.looks for shown in look.values))

    def series(self, shown: Shown) -> list[tuple[float, float | str]]:
        """Return when [s] which value was seen."""
        return [(look.time, look.values[shown]) for look in self.looks if shown in look.values]
