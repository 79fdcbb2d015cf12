"""Who gets the messages of a stream, how much later than the first of them, and how surely."""

from collections.abc import Iterable
from itertools import pairwise
from typing import NamedTuple

from planner import Receiver
from proxy.core.view.tuning import TUNING


class Way(NamedTuple):
    """The way of a message to one robot: it takes `latency` [s] and gets there with the chance `share`."""

    latency: float
    share: float = 1.0


def grouped(ways: Iterable[Way]) -> tuple[float, tuple[Receiver, ...]]:
    """Return the least latency [s], and the receivers with their delays after it; each robot counts once.

    As far as messages get to it. There is at least one way.
    """
    alike: dict[int, list[Way]] = {}
    for way in ways:
        alike.setdefault(round(way.latency / TUNING.alike_latency), []).append(way)
    groups = [_joined(each) for _, each in sorted(alike.items())]
    while len(groups) > TUNING.receiver_groups:
        groups = _with_nearest_joined(groups)
    least = groups[0].latency
    return least, tuple(Receiver(group.latency - least, group.share) for group in groups)


def _joined(ways: list[Way]) -> Way:
    """Return the mean way, by the shares, and the sum of the shares."""
    share = sum(way.share for way in ways)
    if share == 0.0:
        return Way(sum(way.latency for way in ways) / len(ways), 0.0)
    return Way(sum(way.latency * way.share for way in ways) / share, share)


def _with_nearest_joined(groups: list[Way]) -> list[Way]:
    """Join the two neighbours that are closest."""
    gaps = [after.latency - before.latency for before, after in pairwise(groups)]
    at = gaps.index(min(gaps))
    return [*groups[:at], _joined(groups[at : at + 2]), *groups[at + 2 :]]
