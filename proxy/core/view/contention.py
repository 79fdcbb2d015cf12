"""Who competes for the channel: the streams of which more is worth anything to somebody, and is to be expected.

A large team has far more streams than a window has places, and most streams have not changed since the last decision.
So what is asked of streams is kept in rows, and worked out anew only for streams of which something was noted since.
"""

from collections.abc import Container, Mapping, Sequence

from proxy.core.view.peer import Staleness
from proxy.core.view.stream import Stream, at_stake
from proxy.core.view.streams import Streams
from proxy.core.view.subscribers import Subscribers


class Contention:
    """The streams of a view as rows, by robot and key, so that a row's number orders it among equals."""

    def __init__(self, streams: Streams, subscribers: Subscribers, staleness: Staleness) -> None:
        self._table = streams
        self._subscribers = subscribers
        self._staleness = staleness
        self._revision = self._revisions = -1
        self._set_rows([])

    def chosen(
        self, now: float, most: int, robot: str | None = None, besides: Container[tuple[str, str]] = ()
    ) -> list[Stream]:
        """Return those streams that compete for which a window of `most` messages has places, by robot and key.

        With a `robot` only its streams compete, and those `besides` do not.

        Half of the places are for those worth most per byte on the air, half for those that generate next. Both are
        only estimated: a look at each stream has to do.
        """
        rows = self._rows(now)
        if robot is not None:
            rows = [row for row in rows if self._streams[row].robot == robot]
        if besides:
            rows = [row for row in rows if (self._streams[row].robot, self._streams[row].key) not in besides]
        if len(rows) > most:
            rows = self._ranked(now, most, rows)
        return [self._streams[row] for row in rows]

    def _ranked(self, now: float, most: int, rows: list[int]) -> list[int]:
        """Return `most` of these rows, in order. Of 500 that takes a quarter of what sorting lists would."""
        import numpy as np  # noqa: PLC0415 - a daemon that knows no streams does without

        at = np.array(rows)
        due = np.maximum(now, np.array(self._next)[at])
        order = np.lexsort((due, np.array(self._cheapness)[at]))
        best, rest = order[: most // 2], np.sort(order[most // 2 :])
        soonest = rest[np.argsort(due[rest], kind="stable")[: most - len(best)]]
        chosen: list[int] = at[np.sort(np.concatenate((best, soonest)))].tolist()
        return chosen

    def all(self, now: float) -> list[Stream]:
        """Return all streams that compete, by robot and key."""
        return [self._streams[row] for row in self._rows(now)]

    def competes(self, now: float, stream: Stream) -> bool:
        """Whether more of the stream is worth anything to somebody, and more is to be expected.

        How long it is silent only its robot's news tells.
        """
        if stream.last is None or stream.schedule.over(self._staleness.reported_until(stream.robot, now)):
            return False
        return len(self._subscribers.gaining(stream)) > 0

    def _rows(self, now: float) -> list[int]:
        """Return the rows that compete. How long a stream is silent only its robot's news tells."""
        self._renew()
        until = dict(zip(self._robots, self._staleness.all_reported_until(self._robots, now), strict=True))
        rows = zip(self._streams, self._wanted, self._last, self._patience, strict=True)
        return [
            row
            for row, (stream, wanted, last, patience) in enumerate(rows)
            if wanted and until[stream.robot] - last < patience
        ]

    def _renew(self) -> None:
        """Work out anew the rows of streams of which something was noted, or all rows when a change concerns all.

        Where only streams came or went the others keep their rows: a thousand keys that came one by one took 25 s,
        under a profiler, where each had all rows worked out anew, and take 17.
        """
        if self._revision != self._table.revision:
            known = self._row if self._revisions == self._table.revisions else {}
            self._revision, self._revisions = self._table.revision, self._table.revisions
            self._set_rows(sorted(self._table, key=lambda stream: (stream.robot, stream.key)), known)
        for row, (stream, seen) in enumerate(zip(self._streams, self._seen, strict=True)):
            if stream.changes != seen:
                self._look(row, stream)

    def _set_rows(self, streams: list[Stream], known: Mapping[tuple[str, str], int] | None = None) -> None:
        """Have a row for each stream; what a `known` row of the same stream says is kept."""
        kept = self._kept(streams, known or {})
        count = len(streams)
        self._streams = streams
        self._row = {(stream.robot, stream.key): row for row, stream in enumerate(streams)}
        self._seen = [-1] * count
        self._robots = sorted({stream.robot for stream in streams})
        self._wanted = [False] * count
        self._cheapness, self._last, self._patience, self._next = ([0.0] * count for _ in range(4))
        for row, (seen, wanted, *numbers) in kept:
            self._seen[row], self._wanted[row] = seen, wanted
            self._cheapness[row], self._last[row], self._patience[row], self._next[row] = numbers

    def _kept(
        self, streams: Sequence[Stream], known: Mapping[tuple[str, str], int]
    ) -> list[tuple[int, tuple[int, bool, float, float, float, float]]]:
        """Return the rows that streams will have and had before, each with what it says."""
        if not known:
            return []
        said = list(zip(self._seen, self._wanted, self._cheapness, self._last, self._patience, self._next, strict=True))
        before = [known.get((stream.robot, stream.key)) for stream in streams]
        return [
            (row, said[old])
            for row, (stream, old) in enumerate(zip(streams, before, strict=True))
            if old is not None and self._streams[old] is stream
        ]

    def _look(self, row: int, stream: Stream) -> None:
        """Take in what there is to know of a stream: `_cheapness` is what a byte of it is worth, negated."""
        self._seen[row] = stream.changes
        last = stream.last
        gaining = 0 if last is None else len(self._subscribers.gaining(stream))
        self._wanted[row] = gaining > 0
        self._last[row], self._patience[row], self._next[row] = stream.schedule.prospect()
        if last is not None:
            copies = self._subscribers.copies(stream)
            self._cheapness[row] = -at_stake(stream, last.scale) * gaining / max(last.size * copies, 1)
