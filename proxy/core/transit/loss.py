"""What part of the samples sent to a robot gets lost, from two cumulative counts: sent, and received of those."""

from collections import deque

from proxy.core.transit.tuning import TUNING


class Loss:
    """The share of samples lost within the recent past. A count that restarts begins a new past."""

    def __init__(self) -> None:
        self._read: deque[tuple[int, int]] = deque(maxlen=TUNING.loss_readings)
        self._counted = (0, 0)
        self._stale = False

    @property
    def begun(self) -> bool:
        """Whether there was a reading since the last restart."""
        return bool(self._read)

    def read(self, sent: int, received: int) -> None:
        """So many were sent so far, and so many received."""
        if self._read and (sent < self._read[-1][0] or received < self._read[-1][1]):
            self._read.clear()
        if len(self._read) > 1 and self._read[-1][0] - self._read[-2][0] < TUNING.samples_between_readings:
            self._read.pop()
        if not self._read or self._read[-1] != (sent, received):
            self._read.append((sent, received))
        self._stale = True

    def restart(self) -> None:
        """Forget the counts: from now on other samples are counted."""
        self._read.clear()
        self._stale = True

    @property
    def counted(self) -> tuple[int, int]:
        """How many samples were sent in the recent past, and how many of these got lost."""
        if self._stale:
            self._counted, self._stale = self._count(), False
        return self._counted

    @property
    def share(self) -> float | None:
        """Part of the samples that got lost, from 0.0 to 1.0; None while nothing was sent."""
        return share_of(*self.counted)

    def _count(self) -> tuple[int, int]:
        if len(self._read) < 2:
            return 0, 0
        sent, received = (last - first for first, last in zip(self._read[0], self._read[-1], strict=True))
        return sent, max(0, sent - received)


def share_of(sent: int, lost: int) -> float | None:
    """Return the part of so many samples that got lost; None while nothing was sent."""
    return min(1.0, lost / max(sent, TUNING.fewest_samples)) if sent else None
