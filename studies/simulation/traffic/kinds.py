"""Kinds of samples, as an operator would describe them in a spec and as applications publish them."""

from dataclasses import dataclass

import numpy as np

from planner.utility import Flags, Floats, MessageUtility
from studies.simulation.missions import utility_table

START = 1.0
"""Applications start at random within so long [s]."""
PAUSES = (5.0, 15.0)
"""A stream that pauses publishes for so long, then pauses for so long, in turn; all uniformly drawn [s]."""


@dataclass(frozen=True, slots=True)
class Kind:
    """An information type, and what one stream of it is like.

    The stream's rate is drawn from `rates` [Hz], its typical size from `sizes` [B], both log-uniformly. Samples come
    with the period of that rate, each displaced by `jitter` [s], or at random; each has a size around the typical one
    (standard deviation `spread`, as a part), or one of `sizes` drawn `anew`. The part `pausing` of the streams pauses
    now and then. With `red` samples are images in which red things may be seen. Of a `small` kind as good as all
    samples should arrive, of an `alarm` each.
    """

    name: str
    utility: MessageUtility
    rates: tuple[float, float]
    sizes: tuple[float, float]
    weight: float = 1.0
    aggregation: str = "most_recent"
    spread: float = 0.03
    anew: bool = False
    jitter: float = 0.002
    at_random: bool = False
    red: bool = False
    small: bool = False
    alarm: bool = False
    pausing: float = 0.0

    def times(self, draw: np.random.Generator, seconds: float) -> Floats:
        """Draw when one stream generates, in order, before `seconds`."""
        start, rate = draw.uniform(0.0, START), _log_uniform(draw, self.rates)
        count = int(2 * rate * seconds) + 20
        if self.at_random:
            times = start + np.cumsum(draw.exponential(1.0 / rate, count))
        else:
            times = np.maximum(start + np.arange(count) / rate + draw.normal(0.0, self.jitter, count), 0.0)
        times.sort()
        if self.pausing and draw.random() < self.pausing:
            times = times[_published(draw, times, seconds)]
        return np.asarray(times[times < seconds])

    def draw_sizes(self, draw: np.random.Generator, count: int) -> Floats:
        """Draw the sizes of so many samples of one stream [B]."""
        if self.anew:
            return np.asarray(draw.uniform(*self.sizes, count).round())
        typical = _log_uniform(draw, self.sizes)
        return np.asarray((typical * np.clip(draw.normal(1.0, self.spread, count), 0.5, 1.5)).round())

    def spec(self) -> str:
        """Write the information type as an operator would."""
        lines = [
            "[[information_type]]",
            f'name = "{self.name}"',
            f'keys = ["*/{self.name}"]',
            f'aggregation = "{self.aggregation}"',
            f"weight = {self.weight!r}",
            f"utility = {utility_table([self.utility])}",
        ]
        if self.red:
            lines += ['scale = "1 + 10 * red"', 'features.red = { kind = "color_fraction", color = "red" }']
        return "\n".join(lines)


def _published(draw: np.random.Generator, times: Floats, seconds: float) -> Flags:
    """Draw when a stream pauses, until `seconds` at least; return which of these times are not in a pause."""
    before = PAUSES[1]
    changes = np.cumsum(draw.uniform(*PAUSES, int((before + seconds) / PAUSES[0]) + 1)) - draw.uniform(0.0, before)
    return np.asarray(np.searchsorted(changes, times) % 2 == 0)


def middle(between: tuple[float, float]) -> float:
    """Return the geometric mean of two bounds: what is drawn log-uniformly has it as its median."""
    return float(np.sqrt(between[0] * between[1]))


def _log_uniform(draw: np.random.Generator, between: tuple[float, float]) -> float:
    return float(np.exp(draw.uniform(*np.log(between))))
