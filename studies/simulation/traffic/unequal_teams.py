"""Teams of unequal robots: which kinds each has, how the streams of a kind differ, and when some pause."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from studies.simulation.traffic.kinds import Kind

LATENCIES, LOSSES = (0.002, 0.02, 0.1), (0.0, 0.01)
"""How unequal teams fly: [s], and parts of all samples and digests."""
OWN = 0.5
"""So many of the kinds a robot has, in the mean, as a part."""
FACTOR = 2.0
"""Rates and typical sizes of a kind are less or more by this factor at most: those of two streams differ by up to 4."""
PAUSING = 1 / 3
"""So many of the streams pause, in the mean, as a part."""
TOLD = (
    "each robot has some of the kinds (`of`: so many have one), rates and sizes of a kind differ by up to a factor 4, a"
    " third of the streams pauses for 5 to 15 s now and then, half of the teams lose 1 %."
)
"""What pages say of them."""


def team(draw: np.random.Generator, kinds: Sequence[Kind], robots: int) -> tuple[tuple[Kind, ...], ...]:
    """Draw which of the kinds each robot has; some may have none, but not all of them."""
    varied = tuple(map(_varied, kinds))
    drawn = [tuple(kind for kind in varied if draw.random() < OWN) for _ in range(robots)]
    return tuple(drawn) if any(drawn) else (varied, *drawn[1:])


def _varied(kind: Kind) -> Kind:
    """Return a kind whose streams differ more, and pause; where each size is drawn anew, these differ already."""
    sizes = kind.sizes if kind.anew else _wider(kind.sizes)
    return replace(kind, rates=_wider(kind.rates), sizes=sizes, pausing=PAUSING)


def _wider(between: tuple[float, float]) -> tuple[float, float]:
    return between[0] / FACTOR, between[1] * FACTOR
