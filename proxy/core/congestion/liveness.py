"""Whether anything gets through at all, in both directions.

How often the others can be heard depends on the allowance of digests, which is the same for all: a robot that may
seldom speak expects to hear seldom.
"""

from collections import deque
from collections.abc import Iterable
from itertools import pairwise

from proxy.core.congestion.tuning import TUNING


class Liveness:
    """When we last sent a digest, when one of another robot came, and when an echo told that ours arrived."""

    def __init__(self, now: float) -> None:
        self._sent: deque[float] = deque((now,), maxlen=5)
        self._received = self._newest = now
        self._echoed: deque[float] = deque((now,), maxlen=5)

    @property
    def last_sent(self) -> float:
        """When our last digest was sent [s]."""
        return self._sent[-1]

    def digest_sent(self, now: float) -> None:
        """We send a digest."""
        self._sent.append(now)

    def digest_received(self, now: float, waited: float = 0.0) -> None:
        """A digest of another robot arrived that had waited so long on its way [s]."""
        self._received = now
        self._newest = max(self._newest, now - waited)

    def echo_received(self, now: float) -> None:
        """Another robot echoes a digest of ours for the first time."""
        self._echoed.append(now)

    def restart(self, now: float) -> None:
        """Nobody was there to be heard until now."""
        self._received = self._newest = now
        self._echoed = deque((now,), maxlen=5)

    def interval(self, now: float) -> float:
        """The longest time between two of our last digests [s]; the others' are as far apart."""
        return _longest((*self._sent, now))

    def overdue(self, now: float, bearable: float, robots: int) -> bool:
        """Whether a digest of the others should have come by now: it waits somewhere."""
        usual = max(TUNING.overdue, TUNING.overdue_intervals * self.interval(now) / min(robots, 2))
        return self.staleness(now) > bearable + usual

    def staleness(self, now: float) -> float:
        """How old the newest news is that we have [s]."""
        return now - self._newest

    def silent(self, now: float) -> bool:
        """Whether nothing gets through, one way or the other."""
        silence = max(TUNING.silence, TUNING.silence_intervals * self.interval(now))
        rare = min(TUNING.echo_intervals * _longest(self._echoed), TUNING.longest_echo_silence)
        return now - self._received > silence or now - self._echoed[-1] > max(TUNING.echo_silence * silence, rare)


def _longest(times: Iterable[float]) -> float:
    """The longest time between two of these that follow each other [s]."""
    return max((after - before for before, after in pairwise(times)), default=0.0)
