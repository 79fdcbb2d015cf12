"""Whether anything gets through at all, in both directions. Silence is no good news.

How often the others can be heard depends on the allowance of digests, which is the same for all: who may seldom speak
expects to hear seldom.
"""

from collections import deque
from collections.abc import Iterable
from itertools import pairwise

OVERDUE, SPARE = 0.35, 2.0
"""Where much is sent something is overdue after so long [s], and after so many times what lies between our digests."""
SILENCE = 2.5
"""Robots say something every second if they may: silence is at least this long [s]."""
GAPS = 3.0
"""And so many times what lies between two digests of ours."""
ECHOES = 1.6
"""That our own digests arrived is told more rarely, by so much at least,"""
RARELY = 2.0
"""and so many times what lay between the last times that it was told;"""
LONGEST = 10.0
"""but silence is no longer than this for that [s]."""


class Hearing:
    """When others were last heard, when they last told that they heard us, and when we last said something."""

    def __init__(self, now: float) -> None:
        self._said: deque[float] = deque((now,), maxlen=5)
        self._heard = now
        self._newest = now
        self._heard_by: deque[float] = deque((now,), maxlen=5)

    @property
    def last_said(self) -> float:
        """When our last digest went out [s]."""
        return self._said[-1]

    def said(self, now: float) -> None:
        """A digest of ours goes out."""
        self._said.append(now)

    def heard(self, now: float, waited: float = 0.0) -> None:
        """A digest of another robot arrived that had waited so long on its way [s]."""
        self._heard = now
        self._newest = max(self._newest, now - waited)

    def heard_by(self, now: float) -> None:
        """Another robot tells that a digest of ours arrived which it had not told of before."""
        self._heard_by.append(now)

    def restart(self, now: float) -> None:
        """Nobody was there to be heard until now."""
        self._heard = self._newest = now
        self._heard_by = deque((now,), maxlen=5)

    def gap(self, now: float) -> float:
        """The longest time between two of our last digests [s]; the others' are as far apart."""
        return _longest((*self._said, now))

    def overdue(self, now: float, bearable: float, robots: int) -> bool:
        """Whether the others should have been heard by now: what they said waits somewhere."""
        return self.stale(now) > bearable + max(OVERDUE, SPARE * self.gap(now) / min(robots, 2))

    def stale(self, now: float) -> float:
        """How old the newest is that we have heard [s]."""
        return now - self._newest

    def silent(self, now: float) -> bool:
        """Whether nothing gets through, one way or the other."""
        patience = max(SILENCE, GAPS * self.gap(now))
        rarely = max(ECHOES * patience, min(RARELY * _longest(self._heard_by), LONGEST))
        return now - self._heard > patience or now - self._heard_by[-1] > rarely


def _longest(times: Iterable[float]) -> float:
    """The longest time between two of these that follow each other [s]."""
    return max((after - before for before, after in pairwise(times)), default=0.0)
