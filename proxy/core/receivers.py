"""Who gets the messages of a stream, and how much later than the first of them."""

from collections.abc import Iterable
from itertools import pairwise

from planner import Receiver

MOST_GROUPS = 4
"""Receivers are told apart by their latency in at most so many groups: each makes a decision slower."""
ALIKE = 1e-3
"""Latencies that round to the same multiple of this are one group [s]."""

_Group = tuple[float, int]
"""Mean latency [s], robots."""


def grouped(latencies: Iterable[float]) -> tuple[float, tuple[Receiver, ...]]:
    """Return the least latency [s], and the receivers with their delays after it; each robot counts once.

    There is at least one latency.
    """
    alike: dict[int, list[float]] = {}
    for latency in latencies:
        alike.setdefault(round(latency / ALIKE), []).append(latency)
    groups = [(sum(each) / len(each), len(each)) for _, each in sorted(alike.items())]
    while len(groups) > MOST_GROUPS:
        groups = _with_nearest_joined(groups)
    least = groups[0][0]
    return least, tuple(Receiver(latency - least, float(robots)) for latency, robots in groups)


def _with_nearest_joined(groups: list[_Group]) -> list[_Group]:
    """Join the two neighbours that are closest."""
    gaps = [after - before for (before, _), (after, _) in pairwise(groups)]
    at = gaps.index(min(gaps))
    (early, few), (late, more) = groups[at : at + 2]
    return [*groups[:at], ((early * few + late * more) / (few + more), few + more), *groups[at + 2 :]]
