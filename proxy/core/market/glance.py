"""What can be said of streams at any moment, such as in the status, without changing what later decisions remember."""

from proxy.core.market.standing import Amounts, count_new, rows_of
from proxy.core.model.limits import Limit
from proxy.core.view.audience import Audiences
from proxy.core.view.stream import Sent, Stream
from proxy.core.view.view import SharedView

KILOBYTE = 1000


class Glance:
    """A look at all streams of a view `now` [s], with audiences of its own."""

    def __init__(self, view: SharedView, now: float) -> None:
        self._view = view
        self._now = now
        self._audiences = Audiences(view.settings, view.members, view.subscribers, view.paths)

    def wanted(self, stream: Stream) -> tuple[int, float | None]:
        """Return how many robots want a stream, and what its last sample takes to them in the mean [s], if any do."""
        wanting = self._view.subscribers.of(stream)
        if not wanting or stream.last is None:
            return len(wanting), None
        audience = self._audiences.among(self._now, stream, wanting)
        return len(wanting), audience.mean if audience.share > 0.0 else None

    def there(self, stream: Stream, latency: float | None) -> Sent | None:
        """Return the newest sample that should have arrived by now; None if none has, or none is wanted."""
        if latency is None:
            return None
        for sent in reversed(stream.recent):
            if sent.t_sent + latency <= self._now:
                return sent
        return None

    def prices(self, limits: tuple[Limit, ...], *, alone: bool, turns: bool) -> Amounts:
        """Return what a unit of each limit costs [utility·s]; `alone`: only our own streams compete for our part.

        Those with larger messages do not if these take `turns`.
        """
        view, now = self._view, self._now
        competing = view.contention.all(now, view.settings.robot if alone else None) if limits else []
        rows = rows_of(now, view, self._audiences, competing, limits, new=count_new(now, competing, limits))
        if turns:
            rows = [row for row in rows if row.has_room(limits)]
        if not rows:
            return (0.0,) * len(limits)
        from proxy.core.market.prices import Market

        return tuple(Market.of(rows, limits, view.settings.horizon)[0].prices)


def price_of_kilobyte(limit: Limit, price: float) -> float:
    """Return what 1 kB costs more in one copy, at the price of a unit of the limit [utility·s]."""
    return price * (limit.measure.use(2 * KILOBYTE, 1, own=True) - limit.measure.use(KILOBYTE, 1, own=True))
