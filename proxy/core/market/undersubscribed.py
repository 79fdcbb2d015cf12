"""Undersubscribed limits: all streams fit easily, so samples go without a search.

New streams are taken to generate as many again as they did so far; their first samples are decided unless that is a
small part of every limit, or many samples wait.
"""

import operator
from collections.abc import Iterable, Sequence

from proxy.core.market.presumed import Presumed
from proxy.core.market.standing import Amounts, rate_known
from proxy.core.market.tuning import TUNING
from proxy.core.model.limits import Limit
from proxy.core.view.stream import Stream
from proxy.core.view.view import SharedView


def need(view: SharedView, stream: Stream, limits: Sequence[Limit], now: float) -> Amounts:
    """Return what a stream takes of each limit in any window when all its samples are sent."""
    size, copies = stream.newest.size, view.subscribers.copies(stream)
    return tuple([c.measure.use(size, copies, own=True) * _most(stream, c.window, now) for c in limits])


def _most(stream: Stream, window: float, now: float) -> float:
    """Return how many samples a stream generates in any window: a new one no more than as many again as so far.

    In a longer one than rates take to be known so many times more.
    """
    # In any window there may be one more than fit into it evenly.
    by_period = window / stream.period + 1.0
    known = 2.0 * stream.generated * max(1.0, window / TUNING.rate_time)
    return by_period if rate_known(now, stream, window) else min(by_period, known)


class Undersubscribed:
    """Whether all fits. What one stream needs is known at once, what all others do from time to time."""

    def __init__(self, view: SharedView) -> None:
        self._view = view
        self.looks_at = 0.0
        """When it is looked again what all streams need [s]."""
        self._for: tuple[Sequence[Limit], bool] = (), False
        self._needs: dict[tuple[str, str], Amounts] = {}
        self._new: set[tuple[str, str]] = set()
        self._total: Amounts = ()

    def advance(self, now: float, limits: Sequence[Limit], *, alone: bool) -> None:
        """See what all streams that compete need of these limits, ours `alone` or those of all, if it is time to."""
        if now < self.looks_at and self._for == (limits, alone):
            return
        view, self._for = self._view, (limits, alone)
        competing = view.contention.all(now, view.settings.robot if alone else None)
        self._needs = {stream.place: need(view, stream, limits, now) for stream in competing}
        self._new = {stream.place for stream in competing if stream.generated < TUNING.rate_samples}
        known = tuple(map(sum, zip(*self._needs.values(), strict=True))) or (0.0,) * len(limits)
        self._total = known if alone else tuple(map(operator.add, known, self._presumed(now, competing, limits)))
        self.looks_at = now + max(TUNING.interval, TUNING.interval_each * len(self._needs))

    def _presumed(self, now: float, competing: Iterable[Stream], limits: Sequence[Limit]) -> Amounts:
        """Return what robots of which little is known need beside what is known of them, if they need what we do."""
        found = Presumed.of(now, self._view, competing, tuple(limits))
        return found.beside((robot, needed) for (robot, _), needed in self._needs.items())

    def note(self, now: float, stream: Stream) -> None:
        """A stream has generated a sample."""
        place, needed = stream.place, need(self._view, stream, self._for[0], now)
        before = self._needs.get(place, (0.0,) * len(needed))
        self._needs[place] = needed
        (self._new.add if stream.generated < TUNING.rate_samples else self._new.discard)(place)
        self._total = tuple([t + n - b for t, n, b in zip(self._total, needed, before, strict=True)])

    def fits(self, held: Sequence[float], waiting: int, times: float = 1.0) -> bool:
        """Whether all, so many `times`, fits into what is `held` of each limit, while so many other samples wait."""
        new = self._new and waiting <= TUNING.many_waiting
        part = (TUNING.undersubscribed_new if new else TUNING.undersubscribed) / times
        return all(total <= part * amount for total, amount in zip(self._total, held, strict=True))
