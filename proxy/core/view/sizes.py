"""The sizes of a stream's samples: their mean and variance, and what is planned with."""

import math
from dataclasses import dataclass
from statistics import NormalDist

from proxy.core.view.tuning import TUNING


@dataclass(slots=True)
class Sizes:
    """Of the samples that were generated, the recent ones counting more."""

    mean: float = 0.0
    """[B]"""
    variance: float = 0.0
    """[B²]"""
    announced: int = 0
    """What the stream's robot last announced, so that all robots know the same; 0: nothing yet [B]."""

    @property
    def deviation(self) -> float:
        """The standard deviation [B]."""
        return math.sqrt(self.variance)

    def note(self, size: int) -> None:
        """A sample of so many bytes was generated; older ones fade exponentially."""
        if not self.mean:
            self.mean = float(size)
            return
        off = size - self.mean
        weight = TUNING.newest_size_weight
        self.mean += weight * off
        self.variance = (1.0 - weight) * (self.variance + weight * off * off)

    def announce(self, size: int) -> None:
        """The stream's robot announced this size [B]."""
        self.announced = size

    def likely(self, newest: int) -> int:
        """The size that a sample to come is planned with, after the newest one: a bit less than the mean [B]."""
        if self.variance == 0.0:
            return newest
        likely = self.mean - TUNING.sent_size_deviations * self.deviation
        return round(max(likely, TUNING.least_likely_size * self.mean))

    def smallest(self, part: float) -> int:
        """The mean size of the smallest `part` of the samples [B], if sizes are spread about the mean like a bell."""
        normal = NormalDist()
        below = normal.pdf(normal.inv_cdf(part)) / part * self.deviation
        return round(max(self.mean - below, TUNING.smallest_size_part * self.mean))
