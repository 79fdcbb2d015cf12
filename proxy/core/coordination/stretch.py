"""Where messages are larger than what a limit leaves in its window, they are counted in a longer one.

It is as long as such a message takes beside what is booked. In it all that is sent keeps the limit on average, and in
the window itself what is sent beside large messages keeps it alone: three robots that sent each other frames of 35 kB,
70 kB in all copies, where a window of 1 Mbit/s holds 62, sent none as long as poses took 6 %, when a window had to be
empty for them. Not for a stream some of whose samples fit, by their mean and how much they vary: these are sent.

So it is where we keep to an equal part as claims of others are hollow: six robots that began to sent no frame in 30 s
beside their own poses. Parts that were agreed on have turns for what is larger.
"""

from collections.abc import Iterable, Sequence

from proxy.core.coordination.sends import OthersSends, OwnSends
from proxy.core.coordination.tuning import TUNING
from proxy.core.market.standing import Amounts
from proxy.core.model.limits import Limit, Send, stretched
from proxy.core.model.tuning import TUNING as MODEL


class Stretch:
    """How many windows long the window of each limit is, in the order of the limits."""

    def __init__(self, own: OwnSends, others: OthersSends) -> None:
        self._own, self._others = own, others
        self._booked: Amounts = ()
        """What is booked for other messages."""
        self._largest: Amounts = ()
        """What a sample uses of the contested stream with the largest, if they do not fit beside that; else 0."""

    def weigh(
        self,
        limits: Sequence[Limit],
        booked: Amounts,
        contested: Iterable[tuple[Amounts, Amounts]],
        sent: Amounts = (),
    ) -> None:
        """Beside contested messages so much of each limit may be used; they use so much, and vary by so much.

        So much is `sent` whatever they need: what is bulky and does not fit beside that is too large, as what exceeds
        the limit is. Not where that takes much of a limit: six robots used 1.2 limits so, and 1.1 without.
        """
        largest = [0.0] * len(limits)
        for use, deviation in contested:
            for k, limit in enumerate(limits):
                least = use[k] - TUNING.larger_deviations * deviation[k]
                beside = sent[k] if sent and sent[k] <= TUNING.beside_bulky * limit.limit else 0.0
                left = limit.limit - (booked[k] if use[k] > limit.limit else beside)
                if use[k] > MODEL.bulky * limit.limit and least > left:
                    largest[k] = max(largest[k], use[k] + deviation[k])
        self._booked, self._largest = booked, tuple(largest)

    def ordinary(self, limits: Sequence[Limit]) -> Amounts:
        """Return what the largest messages use for which nothing is stretched."""
        return tuple([min(self._left(k, c), c.limit) if self._stretches(k) else c.limit for k, c in enumerate(limits)])

    def planned(self, limits: Sequence[Limit]) -> Amounts:
        """Return the windows' lengths for plans, which know the largest message to come [windows]."""
        if len(self._largest) != len(limits):
            return (1.0,) * len(limits)
        return tuple([self._windows(k, limit, self._largest[k]) for k, limit in enumerate(limits)])

    def limits(self, now: float, limits: tuple[Limit, ...], use: Amounts, *, alone: bool) -> tuple[Limit, ...]:
        """Return the limits as they bind a message with this use now; they are our part if we are `alone`."""
        windows = [
            self._now(now, k, limits, self._needed(k, limits[k], amount), alone=alone) for k, amount in enumerate(use)
        ]
        return limits if max(windows, default=1.0) <= 1.0 else stretched(limits, windows)

    def is_ordinary(self, use: Amounts, limits: Sequence[Limit]) -> bool:
        """Whether no window is stretched for a message with this use."""
        return all(self._windows(k, limit, use[k]) <= 1.0 for k, limit in enumerate(limits))

    def beside(self, sends: Iterable[Send], limits: Sequence[Limit]) -> list[Send]:
        """Return those sends for which no window is stretched: they keep the limit in each one without the others."""
        return [send for send in sends if self.is_ordinary(send[1], limits)]

    def room(
        self, now: float, k: int, limits: tuple[Limit, ...], message: float, *, longer: float, alone: bool
    ) -> float:
        """Return what is left of a limit for a message in the window that ends now and began `longer` ago than it does.

        Messages for which windows are stretched count in these, and in no others. Only our own if we are `alone`.
        """
        limit, needed = limits[k], self._needed(k, limits[k], message)
        windows = self._now(now, k, limits, needed, alone=alone)
        since = now - (windows * limit.window + longer)
        room = windows * limit.limit - self.used(since, k, limits, windows, alone=alone)
        if windows > needed == 1.0:
            since = now - (limit.window + longer)
            bulky = [
                use[k] for _, use in self._bulky(since, limits, alone=alone) if self._windows(k, limit, use[k]) > 1.0
            ]
            room = min(room, limit.limit - self.used(since, k, limits, 1.0, alone=alone) + sum(bulky))
        return room

    def used(self, since: float, k: int, limits: tuple[Limit, ...], windows: float, *, alone: bool) -> float:
        """Return what counts of a limit since then, so many windows ago."""
        used = self._own.used(since, k)
        return used if alone else used + self._others.used(since - self._own.leave_after, k, limits, windows)

    def _now(self, now: float, k: int, limits: tuple[Limit, ...], longest: float, *, alone: bool) -> float:
        """Return the length of window `k` now for a message that needs one so long [windows]."""
        limit = limits[k]
        fitting = self._fitting(k, limit)
        for t, use in self._bulky(now - TUNING.stretched_windows * limit.window, limits, alone=alone):
            if use[k] > fitting and t + (windows := self._windows(k, limit, use[k])) * limit.window > now:
                longest = max(longest, windows)
        return longest

    def _bulky(self, since: float, limits: tuple[Limit, ...], *, alone: bool) -> list[Send]:
        """Return what was sent since then that windows may be stretched for."""
        own = self._own.bulky.since(since) if self._own.bulky else []
        return own if alone else own + self._others.bulky(since - self._own.leave_after, limits)

    def _needed(self, k: int, limit: Limit, message: float) -> float:
        """Return how many windows a message of ours takes for which they may be stretched."""
        return self._windows(k, limit, message) if self._stretches(k) else 1.0

    def _windows(self, k: int, limit: Limit, message: float) -> float:
        """Return how many windows a message takes."""
        if message <= self._fitting(k, limit):
            return 1.0
        return min(message / self._left(k, limit), TUNING.stretched_windows)

    def _fitting(self, k: int, limit: Limit) -> float:
        """Return what the largest messages use that take one window."""
        return self._left(k, limit) if self._stretches(k) else limit.limit

    def _left(self, k: int, limit: Limit) -> float:
        """Return what is left of a limit beside what is booked."""
        booked = self._booked[k] if k < len(self._booked) else 0.0
        return max((1.0 - TUNING.beside_oversized) * limit.limit - booked, TUNING.least_limit)

    def _stretches(self, k: int) -> bool:
        """Whether there are messages for which a window has to be stretched."""
        return k < len(self._largest) and self._largest[k] > 0.0
