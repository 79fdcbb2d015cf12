"""When to tell the others what, within the allowance.

The allowance is a bucket of bytes. Urgent news may empty it, ordinary news half of it. States, questions and answers
are paid for later: until then half of what comes in goes there, and no other state is published. What is told goes in
turn: of echoes, of grants and of news that may have been lost, each digest has a few.
"""

from collections.abc import Iterable

from proxy.core.fixed import rounded
from proxy.core.limits import LEAST_ALLOWANCE, LEAST_DIGEST
from proxy.core.stream import Stream
from proxy.core.wire import Echo, Grant, StreamDigest

SLOW = 1.0
"""A digest goes out at least this often, and each peer is echoed at most so often [s]."""
OVERHEAD = 15
"""What Zenoh adds to a digest: the length of the batch, its frame, and the number for the key [B]."""
QUESTION = 75
"""What asking for a state takes, the head of the answer included [B]."""
MOST_STREAMS = 32
"""News of at most this many streams in one digest."""
MOST_ECHOES = 8
"""Peers echoed in one digest."""
ECHO = 23
"""What an echo takes [B]..."""
ECHOING = 0.25
"""... and the part of the allowance that echoes may take in the long run."""
MOST_GRANTS = 16
"""Grants in one digest; changed ones come first, and are repeated twice."""
REFRESH = 10.0
"""What was told of a stream is told again after this time: it may have been lost [s]."""
MOST_REFRESHED = 2
"""Streams told again in one digest."""
SAVED = 10.0
"""So much of the allowance may be saved for states [s]."""


class DigestPacer:
    """Spends the allowance of this robot."""

    def __init__(self, now: float) -> None:
        self._rate = LEAST_ALLOWANCE
        self._tokens = LEAST_ALLOWANCE
        self._debt = -SAVED * LEAST_ALLOWANCE
        self._updated = now
        self._cost = 150.0
        self._last = now - SLOW
        self._echoing = 0.0
        self._echoed: dict[str, float] = {}
        self._granted: dict[tuple[str, int], tuple[int, int]] = {}
        """The total last told of each grant, and how often it was."""
        self._told: dict[str, tuple[float, StreamDigest]] = {}
        """What was last told of each own stream, by its key, and when."""

    def set_rate(self, rate: float) -> None:
        """The allowance of this robot is now `rate` [B/s], all copies together."""
        self._rate = rate

    def due(self, now: float, *, urgent: bool, news: bool) -> float:
        """When the next digest may go out, in our clock [s]; now or earlier means at once."""
        self._fill(now)
        needed = self._cost if urgent else 2.0 * self._cost
        rate = self._rate if self._debt <= 0.0 else self._rate / 2.0
        affordable = now + max(0.0, needed - self._tokens) / rate
        return affordable if urgent or news else max(affordable, self._last + SLOW)

    def state_due(self, now: float) -> float:
        """When the next state may be published, in our clock [s]."""
        self._fill(now)
        return now + max(0.0, self._debt) / (self._rate / 2.0)

    def sent(self, now: float, size: int, copies: int) -> None:
        """A digest of so many bytes went out in so many copies."""
        self._fill(now)
        self._cost = max(size + OVERHEAD, LEAST_DIGEST) * max(1, copies)
        self._tokens -= self._cost
        self._last = now

    def owe(self, now: float, size: int, copies: int) -> None:
        """Something else of so many bytes went out in so many copies: it is paid for in time."""
        self._fill(now)
        self._debt += (size + OVERHEAD) * copies

    def changed(self, now: float, streams: list[Stream]) -> tuple[StreamDigest, ...]:
        """News of own streams since they were last told of, the most changed first, and some that may be lost."""
        known = {s.key for s in streams}
        self._told = {key: told for key, told in self._told.items() if key in known}
        current = [(s, d) for s in streams if (d := _of(s)) is not None]
        news = [(s, d) for s, d in current if s.key not in self._told or self._told[s.key][1] != d]
        news.sort(key=lambda entry: -self._weight(*entry))
        old = [(s, d) for s, d in current if s.key in self._told and now >= self._told[s.key][0] + REFRESH]
        old.sort(key=lambda entry: self._told[entry[0].key][0])
        chosen = (news + [entry for entry in old if entry not in news][:MOST_REFRESHED])[:MOST_STREAMS]
        self._told.update({s.key: (now, d) for s, d in chosen})
        return tuple(digest for _, digest in chosen)

    def echoes(self, now: float, echoes: Iterable[Echo]) -> tuple[Echo, ...]:
        """Some of the echoes: of those peers that were not echoed for longest."""
        known = {echo.peer: echo for echo in echoes}
        self._echoed = {peer: at for peer, at in self._echoed.items() if peer in known}
        due = [peer for peer in known if now >= self._echoed.get(peer, now - SLOW) + SLOW]
        self._fill(now)
        most = min(MOST_ECHOES, int(self._echoing / (ECHO * max(1, len(known)))))
        chosen = sorted(due, key=lambda peer: (self._echoed.get(peer, -1e18), peer))[:most]
        self._echoing -= ECHO * len(known) * len(chosen)
        self._echoed.update(dict.fromkeys(chosen, now))
        return tuple(known[peer] for peer in chosen)

    def grants(self, grants: Iterable[Grant]) -> tuple[Grant, ...]:
        """Some of the grants: those that changed, then those told least often since."""
        known = {(grant.peer, grant.constraint): grant for grant in grants}
        told = {place: self._granted.get(place, (-1, 0)) for place in known}
        times = {place: count if known[place].total == total else 0 for place, (total, count) in told.items()}
        chosen = sorted(known, key=lambda place: (times[place], place))[:MOST_GRANTS]
        often = [place for place in chosen if times[place] < 3] or chosen[:1]
        self._granted = told | {place: (known[place].total, times[place] + 1) for place in often}
        return tuple(known[place] for place in often)

    def has_news(self, streams: list[Stream]) -> bool:
        """Whether any stream changed since it was last told of."""
        return any(s.key not in self._told or self._told[s.key][1] != _of(s) for s in streams if s.last is not None)

    def value_changed(self, stream: Stream) -> bool:
        """Whether the stream's value changed enough since it was last told of to alter others' plans."""
        told = self._told.get(stream.key)
        if told is None or stream.last is None:
            return stream.last is not None
        low, high = sorted((told[1].scale, stream.last.scale))
        return high - low > 0.25 * max(low, 1e-9)

    def forget(self) -> None:
        """Somebody new is there: everything is news again."""
        self._told.clear()
        self._granted.clear()

    def _weight(self, stream: Stream, digest: StreamDigest) -> float:
        told = self._told.get(stream.key)
        return float("inf") if told is None else abs(digest.scale - told[1].scale) + digest.scale

    def _fill(self, now: float) -> None:
        """What came in since then; as much as is owed, up to a half, is paid."""
        came = max(0.0, now - self._updated) * self._rate
        self._updated = max(now, self._updated)
        most = max(3.0 * self._cost, self._rate)
        self._echoing = min(most, self._echoing + ECHOING * came)
        paid = min(max(0.0, self._debt), came / 2.0)
        room = max(0.0, most - self._tokens)
        self._tokens += min(room, came - paid)
        # What the digests do not need is saved.
        self._debt = max(self._debt - paid - max(0.0, came - paid - room), -SAVED * self._rate)


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
        rounded(stream.last.scale),
    )
