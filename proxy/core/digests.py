"""When to tell the others what, within the allowance.

The allowance is a bucket of bytes. Urgent news may empty it, ordinary news half of it. States, questions and answers
are paid for later: until then half of what comes in goes there, and no other state is published. What is told goes in
turn: of echoes, of grants and of news that may have been lost, each digest has a few.
"""

from collections.abc import Iterable

from proxy.core.fixed import feature, rounded
from proxy.core.limits import LEAST_ALLOWANCE, LEAST_DIGEST
from proxy.core.schedules.told import told
from proxy.core.stream import Stream
from proxy.core.wire import Echo, Grant, StreamDigest

SLOW = 1.0
"""A digest goes out at least this often, and each peer is echoed at most so often [s]."""
OVERHEAD = 15
"""What Zenoh adds to a digest: the length of the batch, its frame, and the number for the key [B]."""
ON_AIR = 60
"""What the key takes besides the robot's name where digests are broadcast [B]."""
QUESTION = 75
"""What asking for a state takes, the head of the answer included [B]."""
MOST_STREAMS = 32
"""News of at most this many streams in one digest."""
MOST_ECHOES = 8
"""Peers echoed in one digest."""
MOST_GRANTS = 48
"""Grants in one digest."""
DEBT = 2.0
"""So many digests new streams may be told ahead of the allowance."""
ECHO = 23
"""What an echo takes [B]..."""
ECHOING = 0.25
"""... and the part of the allowance that echoes may take in the long run."""
HEAD_START = 210.0
"""What echoes may take ahead of that [B]: without any nobody knows how long the way is."""
REFRESH = 10.0
"""What was told of a stream is told again after this time: it may have been lost [s]."""
MOST_REFRESHED = 2
"""Streams told again in one digest."""
SAVED = 10.0
"""So much of the allowance may be saved for states [s]."""


class DigestPacer:
    """Spends the allowance of this robot."""

    def __init__(self, now: float) -> None:
        self.revision = 0
        """How often what was told of streams changed."""
        self._rate = LEAST_ALLOWANCE
        self._tokens = LEAST_ALLOWANCE
        self._debt = -SAVED * LEAST_ALLOWANCE
        self._updated = now
        self._size = float(LEAST_DIGEST)
        self._depth = 150.0
        """What the dearest of the recent digests cost, all copies together [B]."""
        self._last = now - SLOW
        self._echoing = HEAD_START
        self._echoed: dict[str, float] = {}
        self._ever: set[str] = set()
        """Own keys that were told of at all."""
        self._granted: dict[Grant, int] = {}
        """How often each grant that still holds was told."""
        self._all_told = 0
        """So often all of these were told, at least."""
        self._offered: tuple[Grant, ...] = ()
        """The grants that still hold."""
        self.again = False
        """Whether the grant to be told next was told before: that is not urgent."""
        self._told: dict[str, tuple[float, StreamDigest]] = {}
        """What was last told of each own stream, by its key, and when."""
        self._digests: dict[str, tuple[Stream, int, StreamDigest]] = {}
        """What there is to tell of each stream, by its key, since so many changes of it."""

    def set_rate(self, rate: float) -> None:
        """The allowance of this robot is now `rate` [B/s], all copies together."""
        self._rate = rate

    @property
    def interval(self) -> float:
        """How long the allowance takes to pay for a digest to one robot [s]."""
        return self._size / self._rate

    @property
    def solvent(self) -> bool:
        """Whether no more was told than a few digests ahead of the allowance."""
        return self._tokens > -DEBT * self._depth

    def unknown(self, streams: list[Stream]) -> bool:
        """Whether there is a stream that was never told of."""
        return any(s.key not in self._ever and s.last is not None for s in streams)

    def due(
        self, now: float, *, urgent: bool, news: bool, copies: int, spare: int = 1, size: float | None = None
    ) -> float:
        """When the next digest may go out in so many copies, in our clock [s]; now or earlier means at once.

        It is as large as the last one, or of this `size` [B]. Where it is not urgent, `spare` urgent ones could still
        follow it, two at most.
        """
        cost = (self._size if size is None else size) * copies
        self._depth = max(self._depth, cost)
        self._fill(now)
        needed = cost if urgent else (1.0 + spare) * cost
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
        self._size = max(size + OVERHEAD, LEAST_DIGEST)
        cost = self._size * max(1, copies)
        self._depth = max(cost, 0.9 * self._depth)
        self._tokens -= cost
        self._last = now

    def owe(self, now: float, size: int, copies: int) -> None:
        """Something else of so many bytes went out in so many copies: it is paid for in time."""
        self._fill(now)
        self._debt += (size + OVERHEAD) * copies

    def changed(self, now: float, streams: list[Stream]) -> tuple[StreamDigest, ...]:
        """News of own streams since they were last told of, the most changed first, and some that may be lost."""
        self.revision += 1
        known = {s.key for s in streams}
        self._told = {key: told for key, told in self._told.items() if key in known}
        self._digests = {key: digest for key, digest in self._digests.items() if key in known}
        current = [(s, d) for s in streams if (d := self._digest(s)) is not None]
        news = [(s, d) for s, d in current if s.key not in self._told or self._told[s.key][1] != d]
        news.sort(key=lambda entry: -self._weight(*entry))
        old = [(s, d) for s, d in current if s.key in self._told and now >= self._told[s.key][0] + REFRESH]
        old.sort(key=lambda entry: self._told[entry[0].key][0])
        chosen = (news + [entry for entry in old if entry not in news][:MOST_REFRESHED])[:MOST_STREAMS]
        self._told.update({s.key: (now, d) for s, d in chosen})
        self._ever = (self._ever & known) | {s.key for s, _ in chosen}
        return tuple(digest for _, digest in chosen)

    def echoes(self, now: float, echoes: Iterable[Echo], copies: int) -> tuple[Echo, ...]:
        """Some of the echoes, in a digest of so many copies: of those peers that were not echoed for longest."""
        known = {echo.peer: echo for echo in echoes}
        self._echoed = {peer: at for peer, at in self._echoed.items() if peer in known}
        due = [peer for peer in known if now >= self._echoed.get(peer, now - SLOW) + SLOW]
        self._fill(now)
        most = min(MOST_ECHOES, int(self._echoing / (ECHO * max(1, copies))))
        chosen = sorted(due, key=lambda peer: (self._echoed.get(peer, -1e18), peer))[:most]
        self._echoing -= ECHO * copies * len(chosen)
        self._echoed.update(dict.fromkeys(chosen, now))
        return tuple(known[peer] for peer in chosen)

    def addressee(self, grants: Iterable[Grant], often: int = 1) -> str:
        """Who is to be told of a grant next: of the one told least often that begins first; nobody when all are told.

        Each is told so `often`, as digests may be lost.
        """
        offered = tuple(grants)
        if offered is not self._offered and offered != self._offered:
            self._granted = {grant: self._granted.get(grant, 0) for grant in offered}
            self._all_told = 0
        self._offered = offered
        if self._all_told >= often:
            self.again = False
            return ""
        untold = [(times, grant) for grant, times in self._granted.items() if times < often]
        times, grant = min(untold, key=lambda each: (each[0], each[1].begins, each[1].peer), default=(0, None))
        self.again = times > 0
        if grant is None:
            self._all_told = often
            return ""
        return grant.peer

    def grants(self, to: str, often: int = 1) -> tuple[Grant, ...]:
        """What of the grants a digest `to` this robot tells, or to all: those told least often, that begin first."""
        concerned = [g for g, times in self._granted.items() if times < often and to in ("", g.peer)]
        chosen = sorted(concerned, key=lambda g: (self._granted[g], g.begins, g.peer))[:MOST_GRANTS]
        self._granted.update({grant: self._granted[grant] + 1 for grant in chosen})
        return tuple(chosen)

    def has_news(self, streams: list[Stream]) -> bool:
        """Whether any stream changed since it was last told of."""
        for stream in streams:
            if stream.last is None:
                continue
            _, told = self._told.get(stream.key, (0.0, None))
            # Counts are compared first: most news is seen by them, without making a digest of it.
            if told is None or (told.generated, told.forwarded) != (stream.generated, stream.forwarded):
                return True
            digest = self._digest(stream)
            if told is not digest and told != digest:
                return True
        return False

    def value_changed(self, stream: Stream) -> bool:
        """Whether the stream's value changed enough since it was last told of to alter others' plans."""
        told = self._told.get(stream.key)
        if told is None or stream.last is None:
            return stream.last is not None
        low, high = sorted((told[1].scale, stream.last.scale))
        return high - low > 0.25 * max(low, 1e-9)

    def forget(self) -> None:
        """Somebody new is there: everything is news again."""
        self.revision += 1
        self._told.clear()

    def _digest(self, stream: Stream) -> StreamDigest | None:
        """Return what there is to tell of a stream; it is made when the stream has changed."""
        known = self._digests.get(stream.key)
        if known is not None and known[0] is stream and known[1] == stream.changes:
            return known[2]
        digest = _of(stream)
        if digest is not None:
            self._digests[stream.key] = stream, stream.changes, digest
        return digest

    def _weight(self, stream: Stream, digest: StreamDigest) -> float:
        told = self._told.get(stream.key)
        return float("inf") if told is None else abs(digest.scale - told[1].scale) + digest.scale

    def _fill(self, now: float) -> None:
        """What came in since then; as much as is owed, up to a half, is paid."""
        if now <= self._updated:
            return
        came = (now - self._updated) * self._rate
        self._updated = now
        most = max(3.0 * self._depth, self._rate)
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
        tuple(map(feature, stream.information_type.told(stream.last.features))) if stream.last.features else (),
        *told(stream.schedule.rhythm, stream.generated, stream.last.t_gen),
    )
