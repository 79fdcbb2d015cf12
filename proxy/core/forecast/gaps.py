"""The numbers of samples that nobody numbered, from the gaps between those that were heard.

A gap near a whole multiple of the period holds samples that were lost. The period itself is what the shorter gaps have
in common.
"""

from collections.abc import Sequence
from itertools import pairwise
from math import sqrt

from proxy.core.forecast.rhythm import Numbered, Rhythm
from proxy.core.forecast.tuning import TUNING


def gaps_of(times: Sequence[float]) -> list[float]:
    """Return the times between each and the next [s]."""
    return [b - a for a, b in pairwise(times)]


def base_of(gaps: Sequence[float]) -> float:
    """Return what may be the period [s]: the lower quartile, as up to three of four gaps may hold losses."""
    return sorted(gaps)[(len(gaps) - 1) // 4]


def numbered(times: Sequence[float], base: float) -> list[Numbered]:
    """Number times from 0, taking `base` [s] as the period at first and then what was seen so far."""
    points = [(0, times[0])]
    for t in times[1:]:
        number, before = points[-1]
        period = (before - times[0]) / number if number > TUNING.run else base
        points.append((number + max(1, round((t - before) / period)), t))
    return points


def faster(times: Sequence[float], rhythm: Rhythm) -> float | None:
    """Return a shorter period [s] that two of these times' gaps hint at; None when there is none."""
    first, second = sorted(gaps_of(times))[:2]
    return second if second < (1.0 - TUNING.near) * rhythm.period and first > (1.0 - TUNING.near) * second else None


def slower(times: Sequence[float], rhythm: Rhythm, lost: float) -> bool:
    """Whether the last gaps have in common a longer period; `lost` is the part of gaps that hold losses (not 0)."""
    gaps = gaps_of(times)[::-1]
    mean = sum(gaps[: TUNING.run]) / TUNING.run
    same = TUNING.same * max(rhythm.looseness, TUNING.near / 10.0) * mean
    if mean < (1.0 + 2.0 * TUNING.near) * rhythm.period or max(gaps[: TUNING.run]) - min(gaps[: TUNING.run]) > same:
        return False
    spans = [gap / rhythm.period for gap in gaps]
    if any(abs(span - round(span)) > TUNING.near for span in spans[: TUNING.run]):
        return True
    run = next((i for i, span in enumerate(spans) if round(span) != round(spans[0])), len(spans))
    return bool(run >= TUNING.run and lost**run < TUNING.chance)


def spread(points: Sequence[Numbered]) -> float:
    """Return how gaps between numbered times deviate: their median deviation as a part of their median.

    About 0.7 where samples come at random, whatever the gaps between those that were seen; little where they do not.
    """
    gaps = [((t - s), n - m) for (m, s), (n, t) in pairwise(points)]
    middle = sorted([gap / count for gap, count in gaps])[len(gaps) // 2]
    return sorted([abs(gap - count * middle) / sqrt(count) for gap, count in gaps])[len(gaps) // 2] / middle
