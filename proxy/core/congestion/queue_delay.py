"""How long digests wait on their way, seen without knowing anybody's clock.

`received − sent` holds the constant offset of two clocks and the way itself; what it exceeds its least recent value by
is waiting in queues. A queue that only holds what was just sent is empty now and then, so what counts is the least of
the newest few: the part of it that *stands*.
"""

import math
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field

REMEMBERED = 15.0
"""A way is known at its fastest for so long [s]: after that a longer way is taken for what it is."""
NEW = 0.25
"""All times that are this young say whether something stands in the way [s]."""
NEEDED = 2
"""And at least so many,"""
APART = 0.1
"""that span at least this time [s]: robots speak at the same moment when something happens."""
OLD = 5.0
"""Times are kept for so long [s]."""
MOST = 512
"""Times remembered of one way."""


class OneWay:
    """The one-way times from one robot to another."""

    def __init__(self) -> None:
        self._least: deque[tuple[float, float]] = deque(maxlen=MOST)
        """Receipts and times, both rising: candidates for the least of the time that is remembered."""
        self._newest: deque[tuple[float, float, float]] = deque(maxlen=MOST)
        """When each was noted on our clock, when it was sent on its sender's, and its one-way time."""

    @property
    def known(self) -> bool:
        """Whether anything came this way lately."""
        return bool(self._newest)

    def note(self, now: float, sent: float, received: float) -> bool:
        """Something sent then was received then, each by the clock of its robot; False: it is no news."""
        if self._newest and sent <= self._newest[-1][1]:
            return False
        took = received - sent
        while self._least and self._least[-1][1] >= took:
            self._least.pop()
        self._least.append((now, took))
        while self._least[0][0] < now - REMEMBERED:
            self._least.popleft()
        self._newest.append((now, sent, took))
        while self._newest[0][0] < now - OLD:
            self._newest.popleft()
        return True

    @property
    def waited(self) -> float:
        """How long the newest of these waited [s]."""
        return self._newest[-1][2] - self._least[0][1]

    def waits(self, since: float, recent: float) -> list[tuple[float, float]]:
        """When each came that went into the queue since then and is so recent, and how long it waited [s]."""
        waits = [(t, took - self._least[0][1]) for t, _, took in self._newest if t >= recent]
        return [(t, wait) for t, wait in waits if t - wait >= since]

    def share(self, since: float, waited: float, span: float) -> float:
        """How much of what was sent came through since they waited less than that: 1 if the queue does not grow.

        What was sent at once in a `span` [s] is no more than what was sent in that time.
        """
        least = self._least[0][1]
        last_sent, last_took = self._newest[-1][1:]
        short = [(s, took) for t, s, took in self._newest if t >= since and took - least < waited]
        if not short or short[-1][0] >= last_sent:
            return 1.0
        apart = max(span, last_sent - short[-1][0])
        return apart / (apart + max(0.0, last_took - short[-1][1]))


@dataclass(slots=True)
class Ways:
    """Both directions between us and another robot, by digests, and the way there as our own link tells it."""

    here: OneWay = field(default_factory=OneWay)
    there: OneWay = field(default_factory=OneWay)
    link: OneWay = field(default_factory=OneWay)


@dataclass(frozen=True, slots=True)
class Queue:
    """Something waits for `delay` [s], and `share` of what is sent comes through."""

    delay: float
    share: float


def queue(
    now: float, ways: Iterable[OneWay], since: float, bearable: float, *, recent: float = -math.inf, span: float = NEW
) -> Queue | None:
    """What stands in front of several ways of one direction since then; None while two new times do not tell.

    It stands when it was there all the `span` [s]; nothing counts that came before the `recent` past [s]. Where
    something came several ways these are of two: one robot that is far away is no channel that is full.
    """
    ways = [way for way in ways if way.known]
    waits = [(t, wait, way) for way in ways for t, wait in way.waits(since, recent)]
    waits.sort(key=lambda each: -each[0])
    several = len({id(way) for *_, way in waits})
    new: list[tuple[float, float, OneWay]] = []
    for t, wait, way in waits:
        if t < now - span and _tell(new, several):
            break
        new.append((t, wait, way))
    if not _tell(new, several):
        return None
    _, delay, way = min(new, key=lambda each: each[1])
    return Queue(delay, way.share(since, bearable, span))


def _tell(new: list[tuple[float, float, OneWay]], ways: int) -> bool:
    """Whether these are enough, newest first: of two ways where there are two, and apart."""
    apart = len(new) >= NEEDED and new[0][0] - new[-1][0] >= APART
    return apart and len({id(way) for _, _, way in new}) >= min(NEEDED, ways)
