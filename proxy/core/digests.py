"""When to tell the others what, within the allowance."""

from proxy.core.codec import pack_digest
from proxy.core.limits import LEAST_ALLOWANCE, LEAST_DIGEST
from proxy.core.stream import Stream
from proxy.core.wire import Digest, StreamDigest

SLOW = 1.0
"""A digest goes out at least this often [s]."""
OVERHEAD = 24
"""Bytes that Zenoh and the codec add around a digest, besides its own."""
MOST_STREAMS = 32
"""News of at most this many streams in one digest."""


class DigestPacer:
    """Spends the allowance: a token bucket that ordinary news may only half empty, urgent news wholly."""

    def __init__(self, now: float) -> None:
        self._rate = LEAST_ALLOWANCE
        self._tokens = LEAST_ALLOWANCE
        self._updated = now
        self._cost = 150.0
        self._last = now - SLOW
        self._echoed = now - SLOW
        self._told: dict[tuple[str, str], StreamDigest] = {}

    def set_rate(self, rate: float) -> None:
        """The allowance of this robot is now `rate` [B/s], all copies together."""
        self._rate = rate

    def due(self, now: float, *, urgent: bool, news: bool) -> float:
        """When the next digest may go out, in our clock [s]; now or earlier means at once."""
        self._fill(now)
        overdue = now >= self._last + SLOW
        needed = self._cost if urgent or overdue else 2.0 * self._cost
        affordable = now + max(0.0, needed - self._tokens) / self._rate
        return affordable if urgent or news else max(affordable, self._last + SLOW)

    def full(self, now: float) -> bool:
        """Whether the next digest should echo what was heard, which need not be in each."""
        return now >= self._echoed + SLOW

    def sent(self, now: float, digest: Digest, copies: int) -> None:
        """A digest went out in so many copies."""
        self._fill(now)
        self._cost = max(len(pack_digest(digest)) + OVERHEAD, LEAST_DIGEST) * max(1, copies)
        self._tokens -= self._cost
        self._last = now
        if digest.echoes:
            self._echoed = now

    def changed(self, streams: list[Stream]) -> tuple[StreamDigest, ...]:
        """News of own streams since they were last told of, the most changed first."""
        known = {(s.robot, s.key) for s in streams}
        self._told = {place: told for place, told in self._told.items() if place in known}
        news = [(s, d) for s in streams if (d := _of(s)) is not None and self._told.get((s.robot, s.key)) != d]
        news.sort(key=lambda entry: -self._weight(*entry))
        for stream, digest in news[:MOST_STREAMS]:
            self._told[stream.robot, stream.key] = digest
        return tuple(digest for _, digest in news[:MOST_STREAMS])

    def has_news(self, streams: list[Stream]) -> bool:
        """Whether any stream changed since it was last told of."""
        return any(self._told.get((s.robot, s.key)) != _of(s) for s in streams)

    def value_changed(self, stream: Stream) -> bool:
        """Whether the stream's value changed enough since it was last told of to alter others' plans."""
        told = self._told.get((stream.robot, stream.key))
        if told is None or stream.last is None:
            return stream.last is not None
        low, high = sorted((told.scale, stream.last.scale))
        return high - low > 0.25 * max(low, 1e-9)

    def forget(self) -> None:
        """Somebody new is there: everything is news again."""
        self._told.clear()

    def _weight(self, stream: Stream, digest: StreamDigest) -> float:
        told = self._told.get((stream.robot, stream.key))
        return float("inf") if told is None else abs(digest.scale - told.scale) + digest.scale

    def _fill(self, now: float) -> None:
        depth = max(3.0 * self._cost, self._rate)
        self._tokens = min(depth, self._tokens + max(0.0, now - self._updated) * self._rate)
        self._updated = now


def _of(stream: Stream) -> StreamDigest | None:
    if stream.last is None:
        return None
    return StreamDigest(
        stream.id,
        stream.generated,
        stream.forwarded,
        stream.last.t_gen,
        stream.sent.t_sent if stream.sent else 0.0,
        stream.last.size,
        stream.last.scale,
        stream.information_type.told(stream.last.features) if stream.last.features else (),
    )
