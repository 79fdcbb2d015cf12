"""When there is room: sends leave the windows of the limits one after the other, and the channel once it carried them.

Room that another robot's send leaves is not ours: several would wait for it and send at once (in a team of ten 13 % of
the windows were over). Who leads waits for that, too, as do samples each of which counts that are worth far more than
their room costs: alarms.
"""

import math
from bisect import bisect_left, bisect_right
from collections.abc import Collection, Iterable, Iterator, Sequence
from itertools import accumulate

from planner import Constraint
from proxy.core.market.tuning import TUNING
from proxy.core.model.limits import Limit, Send, use_of
from proxy.core.view.stream import Stream
from proxy.core.view.view import SharedView


class SendLog:
    """Sends in the order of their times, and what those since any moment use of each limit: two look-ups, no sum."""

    def __init__(self) -> None:
        self._times: list[float] = []
        self._uses: list[tuple[float, ...]] = []
        self._sums: list[tuple[float, ...]] = []
        """What each send and all before it use together, as far as they are remembered."""
        self._first = 0
        """Those before this place are forgotten: they are taken away when they are as many as those that are left."""
        self.changes = 0
        """How often a send was added or taken out; that one is forgotten changes nothing that still counts."""

    def __len__(self) -> int:
        return len(self._times) - self._first

    def __iter__(self) -> Iterator[Send]:
        """Oldest first."""
        return iter(list(zip(self._times[self._first :], self._uses[self._first :], strict=True)))

    def since(self, t: float) -> list[Send]:
        """Return what was sent since then, oldest first."""
        place = bisect_left(self._times, t, lo=self._first)
        return list(zip(self._times[place:], self._uses[place:], strict=True))

    def add(self, t: float, use: tuple[float, ...]) -> None:
        """Something was sent at `t` [s]."""
        self.add_all(((t, use),))

    def add_all(self, sends: Collection[Send]) -> None:
        """These were sent, in any order: summed up once, for of many that are told late each is before all others."""
        first = len(self._times)
        for t, use in sends:
            place = bisect_right(self._times, t, lo=self._first)
            self._times.insert(place, t)
            self._uses.insert(place, use)
            first = min(first, place)
        if sends:
            self._sum_up(first)

    def replace(self, sends: Sequence[Send]) -> None:
        """These were sent instead, in their order."""
        self._times, self._uses, self._first = [t for t, _ in sends], [use for _, use in sends], 0
        self._sum_up(0)

    def remove(self, send: Send) -> bool:
        """Forget one send; return whether it was there."""
        place = bisect_left(self._times, send[0], lo=self._first)
        while place < len(self._times) and self._times[place] == send[0]:
            if self._uses[place] == send[1]:
                del self._times[place], self._uses[place]
                self._sum_up(place)
                return True
            place += 1
        return False

    def forget(self, before: float) -> None:
        """Of what was sent before this nothing counts any more."""
        self._first = bisect_left(self._times, before, lo=self._first)
        if 2 * self._first > len(self._times):
            del self._times[: self._first], self._uses[: self._first]
            self._first = 0
            self._sum_up(0)

    def used(self, since: float, k: int) -> float:
        """Return what was used of a limit since then."""
        place = bisect_left(self._times, since, lo=self._first)
        if place == len(self._times):
            return 0.0
        return self._sums[-1][k] - (self._sums[place - 1][k] if place else 0.0)

    def exceeded_since(self, k: int, amount: float) -> float:
        """Return when that was sent with which all later sends use more than an amount of limit `k` [s]; else −∞."""
        sums = self._sums
        least = sums[-1][k] - amount if sums else 0.0
        if least <= 0.0:
            return -math.inf
        return self._times[bisect_left(sums, least, key=lambda used: used[k])]

    def _sum_up(self, place: int) -> None:
        """Sum up anew from this place on."""
        self.changes += 1
        del self._sums[place:]
        total = self._sums[-1] if self._sums else ()
        for use in self._uses[place:]:
            total = tuple([a + b for a, b in zip(total, use, strict=True)]) if total else use
            self._sums.append(total)


class Departures:
    """What was sent, newest first, and what leaves the windows with each send: summed up once for all who ask."""

    def __init__(self, own: Iterable[Send], others: Iterable[Send], *, anybodys: bool = False) -> None:
        sends = sorted([*((t, True, use) for t, use in own), *((t, anybodys, use) for t, use in others)], reverse=True)
        self._sends = [(t, ours) for t, ours, _ in sends]
        self._used = [list(accumulate(each)) for each in zip(*(use for *_, use in sends), strict=True)]
        """By constraint, what each send and all after it use."""

    def opens(self, limits: Sequence[Constraint], needed: tuple[float, ...]) -> float:
        """Return when all limits have room for what is `needed`, if nothing else is sent [s]; −∞ where there is now.

        Never (∞) where it is more than a limit, or in room that another robot leaves, unless `anybodys` will do.
        """
        return max((self._opens(c, k, needed[k]) for k, c in enumerate(limits)), default=-math.inf)

    def _opens(self, limit: Constraint, k: int, needed: float) -> float:
        if needed > limit.limit:
            return math.inf
        used = self._used[k] if self._used else []
        place = bisect_right(used, limit.limit, key=lambda amount: amount + needed)
        if place == len(used):
            return -math.inf
        t, ours = self._sends[place]
        return t + limit.window + TUNING.closed if ours else math.inf


class OwnDepartures:
    """The same where nobody else sent anything since then [s]: two look-ups in our own sends, and no sum."""

    def __init__(self, own: SendLog, since: float) -> None:
        self._own = own
        self._since = since

    def opens(self, limits: Sequence[Constraint], needed: tuple[float, ...]) -> float:
        """Return when all limits have room for what is `needed`, if nothing else is sent [s]."""
        return max((self._opens(c, k, needed[k]) for k, c in enumerate(limits)), default=-math.inf)

    def _opens(self, limit: Constraint, k: int, needed: float) -> float:
        if needed > limit.limit:
            return math.inf
        t = self._own.exceeded_since(k, limit.limit - needed)
        return t + limit.window + TUNING.closed if t >= self._since else -math.inf


class Openings:
    """The departures of one kind of room that were asked for last: they stay the same until somebody sends."""

    def __init__(self) -> None:
        self._of: tuple[int, tuple[Send, ...]] = -1, ()
        self._known: tuple[float, Departures | None] = math.inf, None
        """Since when they hold what was sent [s], and they."""

    def after(
        self, since: float, own: SendLog, others: tuple[Send, ...], *, anybodys: bool
    ) -> Departures | OwnDepartures:
        """Return the departures of what was sent since then, or since earlier [s]."""
        if not others:
            return OwnDepartures(own, since)
        if self._of[0] != own.changes or self._of[1] is not others:
            self._of, self._known = (own.changes, others), (math.inf, None)
        known_since, known = self._known
        if known is None or since < known_since:
            counting = [send for send in others if send[0] >= since]
            known = Departures(own.since(since), counting, anybodys=anybodys)
            self._known = since, known
        return known


def pace_part(view: SharedView, stream: Stream, limits: tuple[Limit, ...]) -> float:
    """Return how long a sample of ours keeps the channel busy, as a part of what it takes at the limits' pace.

    A window says how much may be sent, not when; as each waits until the channel is free, the newest frame goes: frames
    of eight robots took 115 to 136 ms by the median (24 Mbit/s offered, 6 carried, three seeds) and take 51; the team
    reaches 91.5 % of the offline optimum instead of 86.2. At most `TUNING.paced`, as waits are in it, and nothing while
    unknown.
    """
    size, copies = round(stream.sizes.mean), view.subscribers.copies(stream)
    slowest = at_pace(use_of(size, copies, limits), limits)
    took = view.paths.on_air(view.subscribers.gaining(stream), size)
    if took is None or slowest <= 0.0:
        return 0.0
    part = took * copies / slowest
    return min(TUNING.paced, part) if part >= TUNING.paced_least else 0.0


def at_pace(use: Sequence[float], limits: tuple[Limit, ...]) -> float:
    """Return how long a message takes that uses so much, at the pace of the slowest limit that robots share [s]."""
    return max([u / c.limit * c.window for u, c in zip(use, limits, strict=True) if c.shared], default=0.0)


def carried(sends: Iterable[Send], limits: tuple[Limit, ...], part: float) -> float:
    """Return when the channel has carried these sends, each in this part of its time [s]; −∞: there are none."""
    free = -math.inf
    for t, use in sorted(sends):
        free = max(free, t) + part * at_pace(use, limits)
    return free
