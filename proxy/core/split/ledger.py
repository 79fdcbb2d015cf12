"""What we sent in the last windows, and which of it counts against our part."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

TIDIED_EVERY = 0.25
"""Sends that left the windows are forgotten this often, in longest windows: not with each of hundreds a second."""


@dataclass(slots=True)
class _Send:
    time: float
    uses: list[float]
    """What it used of each limit [units]."""

    def strike(self, part: float) -> "_Send":
        """Return this part of it, which it loses."""
        struck = _Send(self.time, [part * use for use in self.uses])
        self.uses = [(1.0 - part) * use for use in self.uses]
        return struck


class Ledger:
    """Our sends within each limit's window, as parts of the limits.

    What was sent in room that we give up is *struck off*: nobody else uses that room before it has left the window.
    """

    def __init__(self, windows: Sequence[float]) -> None:
        self.windows = tuple(windows)
        self._longest = max(self.windows)
        self._tidied_at = -math.inf
        self._kept: list[_Send] = []
        self._struck: list[_Send] = []
        self.last_struck = -math.inf
        """When the youngest of what was struck off was sent [s]."""

    def sent(self, now: float, uses: Sequence[float]) -> None:
        """We sent something that uses so much of each limit [units]."""
        if now >= self._tidied_at + TIDIED_EVERY * self._longest:
            self._tidied_at, since = now, now - self._longest
            self._kept = [send for send in self._kept if send.time > since]
            self._struck = [send for send in self._struck if send.time > since]
        self._kept.append(_Send(now, list(uses)))

    @property
    def last(self) -> float:
        """When we sent last [s]; in the future where a message has more than one window for itself."""
        return max((send.time for send in self._kept), default=-math.inf)

    def kept(self, now: float, limit: int) -> float:
        """Return what counts against our part of a limit [units]."""
        return self._within(self._kept, now, limit)

    def struck(self, now: float, limit: int) -> float:
        """Return what does not count, though it is in the window [units]."""
        return self._within(self._struck, now, limit)

    def next_expiry(self, now: float) -> float:
        """Return when something that was struck off leaves a window [s]; infinite where nothing does."""
        ends = (send.time + window for send in self._struck for window in self.windows)
        return min((end for end in ends if end > now), default=float("inf"))

    def strike(self, now: float, left: float, given_up: float) -> None:
        """Strike off what does not fit in what is `left`, up to what is given up [units]."""
        for send, part in self._excess(now, left, given_up):
            self._struck.append(send.strike(part))
            self.last_struck = max(self.last_struck, send.time)
        self._kept = [send for send in self._kept if any(send.uses)]

    def _excess(self, now: float, left: float, room: float) -> list[tuple[_Send, float]]:
        """What does not fit in what is left, and which part of each: large ones first, so that few are."""
        limits = range(len(self.windows))
        rooms, kept = [room] * len(limits), [self.kept(now, limit) for limit in limits]
        excess = []
        for send in sorted(self._kept, key=lambda send: (-max(send.uses), send.time)):
            part = min([1.0, *(free / use for free, use in zip(rooms, send.uses, strict=True) if use > 0.0)])
            if all(amount <= left for amount in kept):
                break
            if part > 0.0 and send.time > now - max(self.windows):
                rooms = [free - part * use for free, use in zip(rooms, send.uses, strict=True)]
                kept = [amount - part * use for amount, use in zip(kept, send.uses, strict=True)]
                excess.append((send, part))
        return excess

    def _within(self, sends: list[_Send], now: float, limit: int) -> float:
        since = now - self.windows[limit]
        return sum(send.uses[limit] for send in sends if send.time > since)
