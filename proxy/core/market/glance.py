"""What can be said of streams at any moment, such as in the status, without changing what later decisions remember."""

from proxy.core.market.standing import Amounts, Row, count_new, row_of
from proxy.core.model.limits import Limit
from proxy.core.view.audience import Audience, Fan, audience_of
from proxy.core.view.stream import Sent, Stream
from proxy.core.view.view import SharedView

KILOBYTE = 1000


class Glance:
    """A look at all streams of a view `now` [s]."""

    def __init__(self, view: SharedView, now: float) -> None:
        self._view = view
        self._now = now
        self._lost = view.paths.mean_loss()
        self._fans: dict[str, Fan] = {}
        self._looked: dict[tuple[str, int, tuple[str, ...]], Audience] = {}
        self._latencies: dict[tuple[str, int, tuple[str, ...]], float | None] = {}

    def wanted(self, stream: Stream) -> tuple[int, float | None]:
        """Return how many robots want a stream, and what its last sample takes to them in the mean [s], if any do."""
        wanting = self._view.subscribers.of(stream)
        if not wanting:
            return 0, None
        place = stream.robot, stream.last.size if stream.last else 0, wanting
        if place not in self._latencies:
            audience = self._audience(stream, wanting)
            self._latencies[place] = audience.mean if audience.share > 0.0 else None
        return len(wanting), self._latencies[place]

    def there(self, stream: Stream, latency: float | None) -> Sent | None:
        """Return the newest sample that should have arrived by now; None if none has, or none is wanted."""
        if latency is None:
            return None
        for sent in reversed(stream.recent):
            if sent.t_sent + latency <= self._now:
                return sent
        return None

    def prices(self, limits: tuple[Limit, ...], *, alone: bool) -> Amounts:
        """Return what a unit of each limit costs [utility·s]; `alone`: only our own streams compete for our part."""
        view, own = self._view, self._view.settings.robot
        competing = [s for s in view.contention.all(self._now) if not alone or s.robot == own] if limits else []
        new = count_new(self._now, competing, limits)
        rows = [self._row(stream, limits, new) for stream in competing]
        if alone:
            rows = [row for row in rows if row.has_room(limits)]
        if not rows:
            return (0.0,) * len(limits)
        from proxy.core.market.prices import Market

        return tuple(Market.of(rows, limits, view.settings.horizon)[0].prices)

    def _row(self, stream: Stream, limits: tuple[Limit, ...], new: int) -> Row:
        subscribers = self._view.subscribers
        audience, copies = self._audience(stream, subscribers.gaining(stream)), subscribers.copies(stream)
        own = stream.robot == self._view.settings.robot
        return row_of(self._now, stream, audience, copies, limits, own=own, new=new)

    def _audience(self, stream: Stream, names: tuple[str, ...]) -> Audience:
        place = stream.robot, stream.last.size if stream.last else 0, names
        if place not in self._looked:
            robot, size, _ = place
            if robot not in self._fans:
                self._fans[robot] = self._view.paths.of(robot)
            self._looked[place] = audience_of(self._fans[robot], names, size, self._lost)
        return self._looked[place]


def price_of_kilobyte(limit: Limit, price: float) -> float:
    """Return what 1 kB costs more in one copy, at the price of a unit of the limit [utility·s]."""
    return price * (limit.measure.use(2 * KILOBYTE, 1, own=True) - limit.measure.use(KILOBYTE, 1, own=True))
