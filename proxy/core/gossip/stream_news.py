"""News of our streams: what there is to tell of each, and what was announced of it last."""

import math
from collections.abc import Container, Iterable
from itertools import accumulate
from operator import attrgetter

from proxy.core.forecast import rhythm_report
from proxy.core.gossip.tuning import TUNING
from proxy.core.protocol.fixed import feature, rounded
from proxy.core.protocol.messages import StreamDigest
from proxy.core.view.stream import Stream

_CHANGES = attrgetter("changes")


class StreamNews:
    """The record of what was announced of each of our streams, by its key."""

    def __init__(self) -> None:
        self.waiting = False
        """Whether there was news when it was last looked for."""
        self.left = False
        """Whether there was more than was told last."""
        self.unknown = False
        """Whether a stream was found then that was never announced."""
        self._revision = 0
        """How often what was announced changed."""
        self._looked_at = (0, 0, -1)
        """The changes of which it is known whether they are news."""
        self._ever: set[str] = set()
        """Keys of streams that were announced at all."""
        self._told_all_at = -math.inf
        """When all that is news of any stream was told last [s]."""
        self._announced: dict[str, tuple[float, StreamDigest]] = {}
        """When each stream was last announced [s], and how."""
        self._digests: dict[str, tuple[Stream, int, StreamDigest]] = {}
        """What there is to tell of each stream, since so many changes of it."""

    def look(self, revision: int, own: Iterable[Stream]) -> None:
        """Look for news, if anything changed: which streams we have, or what is known of one of them.

        What is news stays so until it is announced; beside a stream that never was no others are looked for.
        """
        looked = self._looked_at
        if self.waiting and self._revision == looked[2] and (self.unknown or revision == looked[0]):
            return
        streams = list(own)
        changes = revision, sum(map(_CHANGES, streams)), self._revision
        if changes != self._looked_at:
            self._looked_at = changes
            self.unknown = any(s.key not in self._ever and s.last is not None for s in streams)
            self.waiting = any(map(self._is_news, reversed(streams)))  # what was heard of last is the last

    def take(
        self, now: float, streams: list[Stream], only: Container[str] | None = None, new: Container[str] = ()
    ) -> tuple[StreamDigest, ...]:
        """Return news of streams to announce, the most changed first, or `only` of those that sent or are `new`."""
        self._revision += 1
        known = {s.key for s in streams}
        self._announced = {key: announced for key, announced in self._announced.items() if key in known}
        self._digests = {key: digest for key, digest in self._digests.items() if key in known}
        current = [(s, d) for s in streams if (d := self._digest(s)) is not None]
        news = [(s, d) for s, d in current if s.key in new or self._announced.get(s.key, (0.0, None))[1] != d]
        if only is not None:
            news = [(s, d) for s, d in news if s.key in new or (s.key in only and self._sent_of(s.key) != d.forwarded)]
        news.sort(key=lambda entry: -self._weight(*entry))
        refreshed = [entry for entry in self._old(now, current) if entry not in news] if only is None else []
        chosen = _fitting((news + refreshed[: TUNING.refreshed])[: TUNING.streams])
        self.left = len(chosen) < len(news)
        if only is None and not self.left:
            self._told_all_at = now
        self._announced.update({s.key: (now, d) for s, d in chosen})
        self._ever = (self._ever & known) | {s.key for s, _ in chosen}
        return tuple(digest for _, digest in chosen)

    def forget(self) -> None:
        """A new robot is there: everything is news again."""
        self._revision += 1
        self._announced.clear()

    def value_changed(self, stream: Stream) -> bool:
        """Whether the stream's value changed enough since it was last announced to alter others' plans."""
        announced = self._announced.get(stream.key)
        if announced is None or stream.last is None:
            return stream.last is not None
        if _resumed_since(announced[1], stream):
            return True
        low, high = sorted((announced[1].scale, stream.last.scale))
        return high - low > TUNING.value_change * max(low, 1e-9)

    def introduces(self, stream: Stream) -> bool:
        """Whether a stream was not announced yet, or paused since, or its rhythm was not known then and is now.

        Others wait for that: else eight robots with cameras had 14 % of the windows of their first 8 s over the limit,
        and have 5 (four seeds).
        """
        announced = self._announced.get(stream.key)
        if announced is None:
            return stream.last is not None
        if _resumed_since(announced[1], stream):
            return True
        return announced[1].period == 0.0 and stream.schedule.rhythm is not None

    def ceasing(self, streams: Iterable[Stream]) -> dict[str, float]:
        """Return when those streams are over of which others were told last that they go on, by key [s].

        Where the allowance has no room for all news others left them room until they began again: for 61 % of pauses of
        5 to 15 s, where it takes 35 % until they are over, and for 51 where that is told (37 %).
        """
        told = [(stream, self._announced[stream.key][0]) for stream in streams if stream.key in self._announced]
        ends = ((stream, at, stream.schedule.over_at + TUNING.surely_over) for stream, at in told)
        return {stream.key: end for stream, at, end in ends if max(at, self._told_all_at) < end}

    def _is_news(self, stream: Stream) -> bool:
        """Whether a stream changed since it was last announced."""
        if stream.last is None:
            return False
        _, announced = self._announced.get(stream.key, (0.0, None))
        # Counts are compared first: most news is seen by them, without making a digest of it.
        if announced is None or (announced.generated, announced.forwarded) != (stream.generated, stream.forwarded):
            return True
        digest = self._digest(stream)
        return announced is not digest and announced != digest

    def _digest(self, stream: Stream) -> StreamDigest | None:
        """Return what there is to tell of a stream; it is made when the stream has changed."""
        known = self._digests.get(stream.key)
        if known is not None and known[0] is stream and known[1] == stream.changes:
            return known[2]
        digest = digest_of(stream)
        if digest is not None:
            self._digests[stream.key] = stream, stream.changes, digest
        return digest

    def _old(self, now: float, current: list[tuple[Stream, StreamDigest]]) -> list[tuple[Stream, StreamDigest]]:
        """Return the streams that were announced long ago, the oldest first."""
        at = {s.key: self._announced[s.key][0] for s, _ in current if s.key in self._announced}
        old = [(s, d) for s, d in current if s.key in at and now >= at[s.key] + TUNING.refresh_after]
        return sorted(old, key=lambda entry: at[entry[0].key])

    def _sent_of(self, key: str) -> int | None:
        """How many samples of a stream were sent as was last announced; None: it was not."""
        return self._announced[key][1].forwarded if key in self._announced else None

    def _weight(self, stream: Stream, digest: StreamDigest) -> float:
        announced = self._announced.get(stream.key)
        return float("inf") if announced is None else abs(digest.scale - announced[1].scale) + digest.scale


def _resumed_since(announced: StreamDigest, stream: Stream) -> bool:
    """Whether a stream began again after a pause since it was announced."""
    return announced.t_generated < stream.schedule.resumed


def _fitting(entries: list[tuple[Stream, StreamDigest]]) -> list[tuple[Stream, StreamDigest]]:
    """Return the first ones, as many as a digest has room for, whatever numbers are in there."""
    sizes = accumulate(TUNING.news + TUNING.feature * len(digest.features) for _, digest in entries)
    return [entry for entry, size in zip(entries, sizes, strict=True) if size <= TUNING.news_bytes]


def digest_of(stream: Stream) -> StreamDigest | None:
    """Return what there is to tell of a stream of ours; None where it has generated nothing."""
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
        *rhythm_report.encoded(stream.schedule.rhythm, stream.generated, stream.last.t_gen),
    )
