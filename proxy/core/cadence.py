"""The cadence of a stream that may send so many messages in every window, and for how long its samples should wait.

Samples seldom come when a slot is free again: most leave as soon as they come, and the slot is idle until the next one
does, or the one before waits until it is free, and is older. What is better depends on the period and on how fast what
a sample is worth fades: both are followed here, sample by sample, for every time that samples could wait at most.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from planner import Aggregation, MessageUtility
from planner.utility.base import Floats
from proxy.core.limits import Limit
from proxy.core.stream import Stream
from proxy.core.view import SharedView

PARTS = 100
"""Of a period; times are whole numbers of them."""
WAITS = range(0, PARTS, 10)
"""Samples may wait so long at most [parts of the period]."""
SAMPLES = 60
"""So many samples are followed."""
DENSE = 8
"""Of a stream with more samples in a window hardly any time is lost until the next one comes: none has to wait."""
LEAST_PATIENCE = 0.01
"""A sample waits a little longer than is best: samples come a little early or late [s]."""
SLOWER = 0.01
"""Samples are not taken to need longer by more than this from second to second: some waited without our knowing."""

Amounts = Sequence[float]
"""Of every constraint, in its units."""
Place = tuple[str, str]
"""A stream, by robot and key."""


@dataclass(frozen=True, slots=True)
class Cadence:
    """What so many slots are worth to a stream for each unit of scale [1/s], and how long samples wait for one [s]."""

    rate: float
    patience: float


@dataclass(slots=True)
class _Known:
    utility: MessageUtility
    what: tuple[int, float, float]
    at: float
    latency: float
    cadences: tuple[Cadence, ...]


class Cadences:
    """The cadences of streams whose newest sample counts; worked out anew when something about a stream has changed."""

    def __init__(self, view: SharedView) -> None:
        self._view = view
        self._known: dict[Place, _Known] = {}

    def of(self, now: float, stream: Stream, window: float) -> tuple[Cadence, ...] | None:
        """Return what one message per window is worth to a stream, two, and so on; None where it does not matter when.

        Samples come so densely then, or all of them count, or it is not known how often they come.
        """
        period, kind, place = stream.schedule.period, stream.information_type, (stream.robot, stream.key)
        if kind.aggregation is not Aggregation.MOST_RECENT or period <= 0.0 or window > DENSE * period:
            return None
        utility, latency = kind.utility_of(stream.newest.features), self._view.audiences.of(now, stream).mean
        known = self._known.pop(place, None)
        if known is not None:
            latency = min(latency, known.latency + SLOWER * (now - known.at))
        what = max(1, round(PARTS * window / period)), round(latency, 2), round(period, 2)
        if known is None or known.utility is not utility or known.what != what:
            known = _Known(utility, what, now, latency, cadences_for(utility, latency, period, what[0]))
        if len(self._known) >= self._view.settings.streams:
            del self._known[next(iter(self._known))]
        known.at, known.latency = now, latency
        self._known[place] = known
        return known.cadences

    def patience(
        self, now: float, stream: Stream, limits: Sequence[Limit], use: Amounts, held: Amounts
    ) -> float | None:
        """Return for how long samples of a stream should wait for room in what is `held` [s]; None as in `of`.

        `use` is what a sample takes of the `limits`; nothing else competes for what is held.
        """
        shared = [k for k, limit in enumerate(limits) if limit.shared and use[k] > 0.0]
        window = max((limits[k].window for k in shared), default=0.0)
        count = min((int(held[k] / use[k] + 1e-9) for k in shared), default=0)
        known = self.of(now, stream, window) if count else None
        return None if known is None else LEAST_PATIENCE + known[min(count, len(known)) - 1].patience


def cadences_for(utility: MessageUtility, latency: float, period: float, span: int) -> tuple[Cadence, ...]:
    """Return what each number of slots is worth; `span` is the window in parts of the period [s]."""
    most = -(-span // PARTS)  # that many let it send everything
    return tuple(_best(utility, latency, period, span, count) for count in range(1, most + 1))


def _best(utility: MessageUtility, latency: float, period: float, span: int, count: int) -> Cadence:
    ways = [_course(span, count, wait) for wait in WAITS]
    part, cuts = period / PARTS, np.cumsum([0, *(len(sent) for sent, _, _ in ways[:-1])])
    sent, until = (np.concatenate([way[n] for way in ways]) * part + latency for n in (0, 1))
    rates = np.add.reduceat(utility.integral(sent, until), cuts) / (np.array([way[2] for way in ways]) * part)
    best = int(np.argmax(rates))
    return Cadence(float(rates[best]), WAITS[best] * part)


@lru_cache(maxsize=4096)
def _course(span: int, count: int, patience: int) -> tuple[Floats, Floats, int]:
    """Return the ages at which messages are sent, and at which the next one is, and in what time all were [parts]."""
    begun: deque[int] = deque(maxlen=count)
    ages, times = [], []
    for number in range(SAMPLES):
        generated = PARTS * number
        sent = max(generated, begun[0] + span) if len(begun) == count else generated
        if sent <= generated + patience:
            begun.append(sent)
            ages.append(sent - generated)
            times.append(sent)
    until = [age + after - sent for age, sent, after in zip(ages, times, times[1:], strict=False)]
    return np.array(ages[:-1], dtype=float), np.array(until, dtype=float), times[-1] - times[0]
