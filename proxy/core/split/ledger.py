"""What we sent in the last windows, and which of it counts against our part."""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(slots=True)
class _Send:
    time: float
    uses: list[float]
    """What it used of each limit [units]."""


class Ledger:
    """Our sends within each limit's window, as parts of the limits.

    When our part falls, the room that we give up still holds what we sent in it. Nobody else uses that room before
    this has left the window. So it is *struck off*: it does not count against what we keep, and small messages go on
    beside a large one that was sent in a slot before this was passed on.
    """

    def __init__(self, windows: Sequence[float]) -> None:
        self._windows = tuple(windows)
        self._kept: list[_Send] = []
        self._struck: list[_Send] = []

    def sent(self, now: float, uses: Sequence[float]) -> None:
        """We sent something that uses so much of each limit [units]."""
        longest = now - max(self._windows)
        self._kept = [send for send in self._kept if send.time > longest]
        self._struck = [send for send in self._struck if send.time > longest]
        self._kept.append(_Send(now, list(uses)))

    def kept(self, now: float, limit: int) -> float:
        """Return what counts against our part of a limit [units]."""
        return self._within(self._kept, now, limit)

    def struck(self, now: float, limit: int) -> float:
        """Return what does not count, though it is in the window [units]."""
        return self._within(self._struck, now, limit)

    def next_expiry(self, now: float) -> float:
        """Return when something that was struck off leaves a window [s]; infinite where nothing does."""
        ends = (send.time + window for send in self._struck for window in self._windows)
        return min((end for end in ends if end > now), default=float("inf"))

    def strike(self, now: float, left: float, given_up: float) -> float | None:
        """Strike off what does not fit in what is `left`, up to what is given up: large ones first [units].

        Return when the last of it was sent [s]; None where all fits.
        """
        room, last = [given_up] * len(self._windows), None
        for send in sorted(self._kept, key=lambda send: (-max(send.uses), send.time)):
            if all(self.kept(now, limit) <= left for limit in range(len(room))):
                break
            part = min([1.0, *(free / use for free, use in zip(room, send.uses, strict=True) if use > 0.0)])
            if part > 0.0 and send.time > now - max(self._windows):
                struck = _Send(send.time, [part * use for use in send.uses])
                room = [free - use for free, use in zip(room, struck.uses, strict=True)]
                send.uses = [(1.0 - part) * use for use in send.uses]
                self._struck.append(struck)
                last = max(last or send.time, send.time)
        self._kept = [send for send in self._kept if any(send.uses)]
        return last

    def _within(self, sends: list[_Send], now: float, limit: int) -> float:
        since = now - self._windows[limit]
        return sum(send.uses[limit] for send in sends if send.time > since)
