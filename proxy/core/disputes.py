"""What is disputed: of which streams each sample is worth its price, of which none is, and what is left to decide.

Each limit has a price at which all streams together use it up (`planner/steady.py`). A stream is *undisputed* when even
the last of its samples earns far more than it costs: its samples go without a search, and what they use is booked as
load, so that the tree decides on the rest of the limit. It is *hopeless* when even the first earns far less: its
samples are dropped without a search. All others are *contested*. Where all fits nothing is contested.

What is booked is the *reserve*: what undisputed streams use in a window with hardly an exception. Counts and sizes are
taken as distributions: the reserve is their mean and so many standard deviations.
"""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

import numpy as np

from planner import Aggregation
from planner.received import integrals
from planner.steady import INTERVALS, Steady, clearing_prices
from planner.utility import Floats
from planner.utility.base import told_apart
from proxy.core.inbox import Waiting
from proxy.core.limits import Limit, use_of
from proxy.core.stream import Stream
from proxy.core.view import SharedView

MANY_TIMES = 2.0
"""A stream is undisputed whose last sample a second earns so many times its price..."""
SMALL_PART = 0.3
"""... and hopeless when its first earns no more than this part of it."""
STAY = 1.25
"""What a stream was it stays until it is beyond the bound by this factor."""
SMALL = 0.05
"""... and a stream is undisputed only if none of its samples takes more than this part of a limit: of larger ones the
reserve would keep room for whole samples that seldom come, while the tree knows when they do."""
DEVIATIONS = 3.0
"""The reserve is so many standard deviations above the mean..."""
LEAST_SPREAD = 0.25
"""... and the count of a periodic stream in a window varies at least so much (variance): by one or none."""
MOST_BOOKED = 0.9
"""No more than this part of a limit is booked."""
PACE = 0.25
"""Prices are worked out anew this often [s]..."""
EACH = 1e-3
"""... where many streams compete only after so long for each of them [s]."""
KNOWN = 8
"""Of a stream that generated fewer samples nobody can say how often it does."""

PATIENT_PART = 0.75
LATE = 0.1
SAME = 0.1
Place = tuple[str, str]
"""The robot and key of a stream."""
Amounts = tuple[float, ...]


class Standing(Enum):
    """How a stream stands in the competition."""

    UNDISPUTED = "undisputed"
    PRICED = "priced"
    CONTESTED = "contested"
    HOPELESS = "hopeless"


@dataclass(frozen=True, slots=True)
class Weighed:
    """A stream as it was weighed last: when its sample was worth `scale`.

    `last` is what its last sample a second earns, `first` its first, both in prices; `apart` is how far apart its sends
    are expected [s].
    """

    standing: Standing
    last: float
    first: float
    apart: float
    scale: float
    interval: float


class _Row(NamedTuple):
    """What is known of a stream: of `use` the mean and the deviation, by limit."""

    stream: Stream
    interval: float
    age: float
    scale: float
    use: Amounts
    deviation: Amounts


UNKNOWN = Weighed(Standing.CONTESTED, 1.0, 1.0, 0.0, 0.0, 0.0)


class Disputes:
    """How the streams of a view stand; weighed anew now and then, as limits and streams change."""

    def __init__(self, view: SharedView) -> None:
        self._view = view
        self._looked = -math.inf
        self._for: tuple[Sequence[Limit], bool] = (), False
        self._weighed: dict[Place, Weighed] = {}
        self.settled_places: frozenset[Place] = frozenset()
        """The streams that are no part of any decision, as they are undisputed or hopeless."""
        self._undisputed: tuple[Stream, ...] = ()
        self._reserve: Amounts = ()
        self.late = 0.0

    def look(self, now: float, limits: Sequence[Limit], *, alone: bool) -> None:
        """Weigh all streams that compete for these limits, ours `alone` or those of all, when it is time to."""
        pace = max(PACE, EACH * len(self._weighed))
        if now < self._looked + pace and self._for == (limits, alone):
            return
        self._looked, self._for = now, (limits, alone)
        view = self._view
        competing = view.competition.all(now)
        if alone:
            competing = [stream for stream in competing if stream.robot == view.settings.robot]
        rows = [self._row(now, stream, limits) for stream in competing]
        self._weigh(rows, limits)

    def renew(self, now: float, stream: Stream) -> None:
        """A stream generated a sample: one that was not weighed yet is news."""
        if (stream.robot, stream.key) not in self._weighed and now >= self._looked + EACH * len(self._weighed):
            self._looked = -math.inf

    def weighed(self, stream: Stream) -> Weighed:
        """Return how a stream stands."""
        return self._weighed.get((stream.robot, stream.key), UNKNOWN)

    def standing(self, stream: Stream, sample: Waiting) -> Standing:
        """Return how a sample stands: as its stream does, unless it is worth more or less than that one's last."""
        known = self.weighed(stream)
        if known.standing is Standing.CONTESTED or abs(known.scale - sample.scale) > SAME * known.scale:
            return Standing.CONTESTED
        if known.standing is not Standing.PRICED:
            return known.standing
        due = stream.sent is None or sample.t_gen - stream.sent.t_gen >= known.apart - 0.5 * known.interval
        return Standing.UNDISPUTED if due else Standing.HOPELESS

    def patience(self, stream: Stream) -> float:
        """Return how long a sample waits for room: not until the next one of a Markovian stream is near [s]."""
        if stream.information_type.markovian:
            return PATIENT_PART * stream.schedule.period
        return max((limit.window for limit in self._for[0]), default=0.0)

    def reserve(self, now: float) -> Amounts:
        """Return what is booked of each limit: at least what undisputed streams used in the last window."""
        booked = self.booked(now)
        return tuple(
            [
                min(max(amount, used), max(amount, MOST_BOOKED * limit.limit))
                for amount, used, limit in zip(self._reserve, booked, self._for[0], strict=True)
            ]
        )

    def free(self, now: float) -> Amounts:
        """Return what undisputed streams have not used yet of what is booked for them."""
        booked = self.booked(now)
        return tuple([max(0.0, amount - used) for amount, used in zip(self._reserve, booked, strict=True)])

    def booked(self, now: float) -> Amounts:
        """Return what undisputed streams used of each limit in the window that ends now."""
        limits = self._for[0]
        used = [0.0] * len(limits)
        for t, use in self.sends(now):
            for k, limit in enumerate(limits):
                if t >= now - limit.window:
                    used[k] += use[k]
        return tuple(used)

    def sends(self, now: float) -> list[tuple[float, Amounts]]:
        """Return the sends of undisputed streams within the longest window."""
        limits, own = tuple(self._for[0]), self._view.settings.robot
        since = now - max((limit.window for limit in limits), default=0.0)
        found: list[tuple[float, Amounts]] = []
        for stream in self._undisputed:
            if stream.sent is None or stream.sent.t_sent < since:
                continue
            copies = self._view.copies(stream)
            for sent in reversed(stream.recent):
                if sent.t_sent < since:
                    break
                found.append((sent.t_sent, use_of(sent.size, copies, limits, own=stream.robot == own)))
        return found

    def unbooked(self, now: float, sends: Sequence[tuple[float, Amounts]]) -> list[tuple[float, Amounts]]:
        """Return those of all sends that are not of undisputed streams."""
        booked = Counter(self.sends(now))
        left = []
        for send in sends:
            if booked.get(send, 0) > 0:
                booked[send] -= 1
            else:
                left.append(send)
        return left

    def _row(self, now: float, stream: Stream, limits: Sequence[Limit]) -> _Row:
        view, own = self._view, stream.robot == self._view.settings.robot
        audience, copies = view.audiences.of(now, stream), view.copies(stream)
        size, deviation = stream.mean_size, stream.size_deviation
        use = use_of(size, copies, tuple(limits), own=own)
        more = use_of(size + deviation, copies, tuple(limits), own=own)
        interval = _interval(now, stream, min((c.window for c in limits), default=1.0))
        scale = stream.newest.scale * audience.share
        return _Row(stream, interval, audience.mean, scale, use, tuple([m - u for m, u in zip(more, use, strict=True)]))

    def _weigh(self, rows: Sequence[_Row], limits: Sequence[Limit]) -> None:
        if not rows or not limits:
            self._weighed, self._undisputed, self._reserve = {}, (), (0.0,) * len(limits)
            self.settled_places = frozenset()
            return
        steady = _steady(rows)
        price = clearing_prices(steady, np.array([c.limit / c.window for c in limits]))
        marginal, _ = steady.marginal()
        cost = np.maximum(steady.use @ price, 1e-300)
        last, first = marginal[:, 0] / cost, marginal[:, -1] / cost
        net = steady.value - steady.rate * (steady.use @ price)[:, None]
        best = net.argmax(axis=1)
        pays = net.max(axis=1) > 0.0
        apart = np.where(pays, 1.0 / steady.rate[np.arange(len(rows)), best], math.inf)
        before = self._weighed
        small = [_small(row, limits) for row in rows]
        fits = _reserve(rows, [row.interval for row in rows], limits)
        all_fits = all(booked <= limit.limit for booked, limit in zip(fits, limits, strict=True))
        weighed = {}
        for at, row in enumerate(rows):
            stream = row.stream
            place = stream.robot, stream.key
            known = before.get(place, UNKNOWN)
            one, all_, pause = float(first[at]), float(last[at]), float(apart[at])
            kind = stream.information_type
            standing = Standing.CONTESTED
            if all_fits:
                standing = Standing.UNDISPUTED
            elif not isinstance(kind.aggregation, Aggregation):
                pass
            elif small[at] and all_ >= (1.0 / STAY if known.standing is Standing.UNDISPUTED else 1.0):
                standing = Standing.UNDISPUTED
            elif kind.guarantee.rate > 0.0:
                pass
            elif one <= SMALL_PART * (STAY if known.standing is Standing.HOPELESS else 1.0):
                standing = Standing.HOPELESS
            elif small[at] and kind.markovian and stream.generated >= KNOWN:
                standing = Standing.PRICED
            weighed[place] = Weighed(standing, all_, one, pause, stream.newest.scale, row.interval)
        self._weighed = weighed
        standing = [self.weighed(row.stream).standing for row in rows]
        load = [at for at, each in enumerate(standing) if each in (Standing.UNDISPUTED, Standing.PRICED)]
        self._undisputed = tuple(rows[at].stream for at in load)
        pauses = [rows[at].interval if standing[at] is Standing.UNDISPUTED else float(apart[at]) for at in load]
        reserve = _reserve([rows[at] for at in load], pauses, limits)
        contested = [row for row, each in zip(rows, standing, strict=True) if each is Standing.CONTESTED]
        kept = [max((r.use[k] for r in contested if r.use[k] <= c.limit), default=0.0) for k, c in enumerate(limits)]
        self._reserve = tuple(
            [
                min(booked, MOST_BOOKED * c.limit, c.limit - keep)
                for booked, c, keep in zip(reserve, limits, kept, strict=True)
            ]
        )
        self.settled_places = frozenset(place for place, w in weighed.items() if w.standing is not Standing.CONTESTED)
        periods = [row.interval for row in contested if row.stream.information_type.markovian]
        self.late = LATE * min(periods, default=0.0)


def _small(row: _Row, limits: Sequence[Limit]) -> bool:
    return all(u + d <= SMALL * c.limit for u, d, c in zip(row.use, row.deviation, limits, strict=True))


def _reserve(rows: Sequence[_Row], apart: Sequence[float], limits: Sequence[Limit]) -> Amounts:
    booked = []
    for k, limit in enumerate(limits):
        mean = variance = 0.0
        for row, interval in zip(rows, apart, strict=True):
            count = limit.window / interval
            mean += count * row.use[k]
            variance += _spread(row.stream, count) * row.use[k] ** 2 + count * row.deviation[k] ** 2
        booked.append(mean + DEVIATIONS * math.sqrt(variance))
    return tuple(booked)


def _spread(stream: Stream, count: float) -> float:
    """Return the variance of how many samples a stream generates in a window, `count` in the mean."""
    kind = stream.schedule.kind
    if kind.startswith("periodic"):
        part = count - math.floor(count)
        return max(part * (1.0 - part), LEAST_SPREAD)
    return count + count * count if kind.startswith("bursts") else count


def _interval(now: float, stream: Stream, window: float) -> float:
    """Return the mean time between samples [s]; a new stream generates no more than as many again as so far."""
    period = max(stream.schedule.period, 1e-3)
    if stream.generated >= KNOWN and now - stream.began >= window:
        return period
    return max(period, window / (2.0 * max(stream.generated, 1)))


def _steady(rows: Sequence[_Row]) -> Steady:
    """Return what each stream earns by the interval between its sends."""
    kinds = [row.stream.information_type for row in rows]
    utilities, which = told_apart(
        [k.utility_of(row.stream.newest.features) for k, row in zip(kinds, rows, strict=True)]
    )
    age = np.array([row.age for row in rows])[:, None]
    scale = np.array([row.scale for row in rows])[:, None]
    apart = np.array([row.interval for row in rows])[:, None] * INTERVALS
    area = _areas(utilities, which, age, age + apart) * scale
    for at, kind in enumerate(kinds):
        if kind.aggregation in (Aggregation.SUM, Aggregation.ONCE):
            area[at] = area[at, -1]
    return Steady(np.arange(len(rows)), area / apart, 1.0 / apart, np.array([row.use for row in rows]))


def _areas(utilities, which, begin: Floats, end: Floats) -> Floats:
    rows = np.repeat(which, end.shape[1])
    return integrals(utilities, rows, np.broadcast_to(begin, end.shape).ravel(), end.ravel()).reshape(end.shape)
