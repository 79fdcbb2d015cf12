"""How long digests wait in queues, seen without knowing anybody's clock.

Queue delay is what `received − sent` exceeds its least value of late by; the least of the newest few is that of a
queue.
"""

import math
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

from proxy.core.congestion.tuning import TUNING


class OneWayDelays:
    """The one-way times from one robot to another."""

    def __init__(self) -> None:
        self._base: deque[tuple[float, float]] = deque(maxlen=TUNING.delays_remembered)
        """Receipts and times, both rising: candidates for the base delay."""
        self._newest: deque[tuple[float, float, float]] = deque(maxlen=TUNING.delays_remembered)
        """When each was noted on our clock, when it was sent on its sender's, and its one-way time."""

    @property
    def known(self) -> bool:
        """Whether anything came this way lately."""
        return bool(self._newest)

    def note(self, now: float, sent: float, received: float) -> bool:
        """Something sent then was received then, each by the clock of its robot; return whether it is news."""
        if self._newest and sent <= self._newest[-1][1]:
            return False
        took = received - sent
        while self._base and self._base[-1][1] >= took:
            self._base.pop()
        self._base.append((now, took))
        while self._base[0][0] < now - TUNING.base_delay_memory:
            self._base.popleft()
        self._newest.append((now, sent, took))
        while self._newest[0][0] < now - TUNING.lifetime:
            self._newest.popleft()
        return True

    @property
    def last(self) -> float:
        """How long the newest of these waited [s]."""
        return self._newest[-1][2] - self._base[0][1]

    def delays(self, since: float, recent: float) -> list[tuple[float, float]]:
        """When each came that went into the queue since then and is so recent, and how long it waited [s]."""
        delays = [(t, took - self._base[0][1]) for t, _, took in self._newest if t >= recent]
        return [(t, delay) for t, delay in delays if t - delay >= since]

    def share(self, since: float, bearable: float, span: float) -> float:
        """How much of what was sent came through since delays were bearable, in a `span` [s]: 1 if no queue grows."""
        base = self._base[0][1]
        last_sent, last_took = self._newest[-1][1:]
        short = [(s, took) for t, s, took in self._newest if t >= since and took - base < bearable]
        if not short or short[-1][0] >= last_sent:
            return 1.0
        apart = max(span, last_sent - short[-1][0])
        return apart / (apart + max(0.0, last_took - short[-1][1]))


@dataclass(slots=True)
class PathDelays:
    """Delays of digests from another robot and to it, and of our own link to it."""

    inbound: OneWayDelays = field(default_factory=OneWayDelays)
    outbound: OneWayDelays = field(default_factory=OneWayDelays)
    link: OneWayDelays = field(default_factory=OneWayDelays)


@dataclass(frozen=True, slots=True)
class StandingQueue:
    """A queue of `delay` [s] stands, as was told last at `seen_at` [s], and `share` of what is sent comes through."""

    delay: float
    share: float
    seen_at: float = math.inf

    def left(self, now: float) -> float:
        """What is left of it [s] where it has drained since then, as all who see it send little.

        Digests are rare where limits are low: four robots behind 300 kbit/s sent little for 4 s for the sake of a queue
        that had drained in one. Two reach 98 % of a right limit's utility, and 96 where a queue counts as it was told.
        """
        return self.delay - (1.0 - TUNING.least_while_draining) * max(0.0, now - self.seen_at)


class _Delay(NamedTuple):
    at: float
    delay: float
    path: OneWayDelays


def standing_queue(
    now: float,
    paths: Iterable[OneWayDelays],
    since: float,
    bearable: float,
    *,
    recent: float = -math.inf,
    span: float = TUNING.standing,
) -> StandingQueue | None:
    """What stands in front of several paths of one direction since then; None while two new delays do not tell.

    It was there all the `span` [s] of the `recent` past [s], on two paths where there are two: one may be far away.
    """
    known = [path for path in paths if path.known]
    delays = [_Delay(t, delay, path) for path in known for t, delay in path.delays(since, recent)]
    delays.sort(key=lambda each: -each.at)
    several = len({id(each.path) for each in delays})
    new: list[_Delay] = []
    for each in delays:
        if each.at < now - span and _suffice(new, several):
            break
        new.append(each)
    if not _suffice(new, several):
        return None
    least = min(new, key=lambda each: each.delay)
    return StandingQueue(least.delay, least.path.share(since, bearable, span), new[0].at)


def _suffice(new: list[_Delay], paths: int) -> bool:
    """Whether these delays tell of a queue, newest first: of two paths where there are two, and apart."""
    apart = len(new) >= TUNING.standing_times and new[0].at - new[-1].at >= TUNING.standing_apart
    return apart and len({id(each.path) for each in new}) >= min(TUNING.standing_times, paths)
