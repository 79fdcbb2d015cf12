"""Our part of every shared limit as time passes: what we may use, and what our sends use of it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from proxy.core.protocol.bid import UNIT


class Steady:
    """What was ours throughout the last `window` [s]: a number that falls at once and rises one window later.

    What a robot uses in a window is at most what it had when that began: that holds summed over robots, too.
    """

    def __init__(self, now: float, value: int, window: float) -> None:
        self.window = window
        self._values = [(now, value)]

    def set(self, now: float, value: int, unused: float = 0.0) -> None:
        """It is this from now on; what it rises by has been unused for so long [s]."""
        before = self._values[-1][1]
        rise = value - before
        if not rise:
            return
        since = now - unused if rise > 0 else now
        earlier = [entry for entry in self._values if entry[0] <= since]
        later = self._values[len(earlier) :]
        then = (earlier or later[:1])[-1][1]
        least = min(then, *(had for _, had in later), before)
        self._values = [*earlier, (since, least), (since, then + rise), *((at, had + rise) for at, had in later)]
        first = next(i for i, (_, end) in enumerate(self._spans()) if end > since - self.window)
        self._values = self._values[first:]

    def give_up(self, now: float, value: int, room: int, least: int) -> None:
        """It is `value` from now on, and counts as if some room had never been part of it: `least` always was ours."""
        self._values = [(start, min(had, max(had - room, least))) for start, had in self._values]
        self.set(now, value)

    def least(self, now: float) -> int:
        """Return the least that it was in the window until `now`."""
        return min(value for (value, end) in self._spans() if end > now - self.window)

    def rises_at(self, now: float) -> float:
        """Return when the least of a window rises next [s]; infinite if it does not by itself."""
        least = self.least(now)
        ends = [end for value, end in self._spans() if value == least and end > now - self.window]
        return max(ends) + self.window

    def _spans(self) -> list[tuple[int, float]]:
        """Each value and when it ended."""
        spans = [(value, end) for (_, value), (end, _) in pairwise(self._values)]
        return [*spans, (self._values[-1][1], float("inf"))]


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


class OwnPart:
    """What all tables entitle us to, held back by the guard time of one window, and the sends that count against it."""

    def __init__(self, now: float, windows: Sequence[float], entitled: int) -> None:
        self.window = max(windows)
        self._ledger = Ledger(windows)
        self._steady = Steady(now, entitled, self.window)

    def of(self, now: float, limit: int = 0) -> float:
        """Return what our sends within the window of a limit may use together, as a part of it; `now` may be ahead."""
        return (self._steady.least(now) + self._ledger.struck(now, limit)) / UNIT

    def free(self, now: float, limit: int = 0) -> float:
        """Return what is left of our part of a limit now."""
        return max(0.0, self._steady.least(now) - self._ledger.kept(now, limit)) / UNIT

    def grows_at(self, now: float) -> float:
        """Return when our part grows next, if nothing is heard and no turn ends [s]; ∞ where it does not."""
        return self._steady.rises_at(now)

    def changes_at(self, now: float) -> float:
        """Return when our part changes by time alone [s]."""
        return min(self._steady.rises_at(now), self._ledger.next_expiry(now))

    @property
    def busy_until(self) -> float:
        """When we sent last [s]; in the future where a message has more than one window for itself."""
        return self._ledger.last

    def spent(self, now: float, slot: int) -> bool:
        """Whether less than half of a slot of so many units is left of our part of the first limit."""
        return self._ledger.kept(now, 0) > self._steady.least(now) - slot / 2

    def sent(self, now: float, uses: Sequence[float], windows: float = 1.0) -> None:
        """We sent a message that uses such parts of the shared limits, and has so many windows for itself."""
        self._ledger.sent(now + (windows - 1.0) * self.window, [use * UNIT / windows for use in uses])

    def entitle(self, now: float, entitled: int, unused: float = 0.0) -> None:
        """We are entitled to so many units; what this rises by has been unused for so long [s]."""
        before = self._steady.least(now)
        self._steady.set(now, entitled, unused)
        self._strike(now, before)

    def give_up(self, now: float, entitled: int, slot: int, exclusive: int) -> float:
        """A slot goes to the next robot; return when the last was sent in it [s]. `exclusive`: ours without [units]."""
        before = self._steady.least(now)
        self._steady.give_up(now, entitled, slot, exclusive)
        self._strike(now, before)
        return self._ledger.last_struck

    def _strike(self, now: float, before: int) -> None:
        """Our part was so much before."""
        if (least := self._steady.least(now)) < before:
            self._ledger.strike(now, least, before - least)
