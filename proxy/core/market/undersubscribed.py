"""Ample room: what all streams are to be expected to send fits easily into every limit, so nothing has to be dropped.

Then samples go without a search. Of new streams nobody knows what they need: it is taken that they generate as many
again as they did so far. That is doubtful, so their first samples are decided unless it is a small part of every limit,
or many samples wait, as in a burst: then a search for each would take longer than they are worth.
"""

from collections.abc import Iterable, Sequence

from proxy.core.market.prices import EACH, KNOWN, PACE, Amounts, rate_known
from proxy.core.model.limits import Limit
from proxy.core.view.stream import Stream
from proxy.core.view.view import SharedView

PART = 0.7
"""There is ample room while all need no more than this part of every limit."""
PART_OF_NEW = 0.05
"""... and, while any of them is new, no more than this part. Where new streams come all the time searches for each of
their samples lost others on an idle channel."""
MANY = 8
"""With more samples waiting than this there is no time for searches that are not needed."""


def need(view: SharedView, stream: Stream, limits: Sequence[Limit], now: float) -> Amounts:
    """Return what a stream takes of each limit in any window when all its samples are sent."""
    size, copies = stream.newest.size, view.copies(stream)
    return tuple([c.measure.use(size, copies, own=True) * _most(stream, c.window, now) for c in limits])


def _most(stream: Stream, window: float, now: float) -> float:
    """Return how many samples a stream generates in any window: a new one no more than as many again as so far."""
    # In any window there may be one more than fit into it evenly.
    by_period = window / stream.period + 1.0
    return by_period if rate_known(now, stream, window) else min(by_period, 2.0 * stream.generated)


class Ample:
    """Whether there is ample room. What one stream needs is known at once, what all others do from time to time."""

    def __init__(self, view: SharedView) -> None:
        self._view = view
        self._due = 0.0
        self._for: tuple[Sequence[Limit], bool] = (), False
        self._needs: dict[tuple[str, str], Amounts] = {}
        self._new: set[tuple[str, str]] = set()
        self._total: Amounts = ()

    def fits(
        self, now: float, stream: Stream, limits: Sequence[Limit], held: Sequence[float], waiting: int, *, alone: bool
    ) -> bool:
        """Whether all fits into what is `held` of each limit: what our own streams need, if we hold it `alone`.

        A sample of `stream` is to be decided, and so many others wait.
        """
        if now >= self._due or self._for != (limits, alone):
            self._for = limits, alone
            self._look(now, limits)
        self.note(now, stream)
        part = PART_OF_NEW if self._new and waiting <= MANY else PART
        return all(total <= part * amount for total, amount in zip(self._total, held, strict=True))

    def note(self, now: float, stream: Stream) -> None:
        """A stream has generated a sample."""
        self._set(stream, need(self._view, stream, self._for[0], now))

    def _look(self, now: float, limits: Sequence[Limit]) -> None:
        view, alone = self._view, self._for[1]
        own = (stream for stream in view.own() if view.competes(now, stream))
        competing: Iterable[Stream] = own if alone else view.competition.all(now)
        self._needs, self._total = {}, (0.0,) * len(limits)
        self._new.clear()
        for stream in competing:
            self._set(stream, need(view, stream, limits, now))
        self._due = now + max(PACE, EACH * len(self._needs))

    def _set(self, stream: Stream, needed: Amounts) -> None:
        place = stream.robot, stream.key
        before = self._needs.get(place, (0.0,) * len(needed))
        self._needs[place] = needed
        if stream.generated < KNOWN:
            self._new.add(place)
        else:
            self._new.discard(place)
        self._total = tuple([t + n - b for t, n, b in zip(self._total, needed, before, strict=True)])
