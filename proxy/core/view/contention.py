"""Who competes for the channel: the streams of which more is worth anything to somebody, and is to be expected.

A large team has far more streams than a window has places, and most streams have not changed since the last decision.
So what is asked of streams is kept in arrays, and worked out anew only for streams of which something was noted since.
"""

from collections.abc import Container

import numpy as np
import numpy.typing as npt

from proxy.core.view.staleness import Staleness
from proxy.core.view.stream import Stream
from proxy.core.view.streams import Streams
from proxy.core.view.subscribers import Subscribers

Rows = npt.NDArray[np.intp]
Floats = npt.NDArray[np.float64]


class Contention:
    """The streams of a view as rows, by robot and key, so that a row's number orders it among equals."""

    def __init__(self, streams: Streams, subscribers: Subscribers, staleness: Staleness) -> None:
        self._table = streams
        self._subscribers = subscribers
        self._staleness = staleness
        self._revision = -1
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
            rows = rows[[self._robots[owner] == robot for owner in self._owner[rows].tolist()]] if len(rows) else rows
        if besides:
            rows = rows[[(s.robot, s.key) not in besides for s in (self._streams[row] for row in rows.tolist())]]
        if len(rows) > most:
            due = np.maximum(now, self._next)[rows]
            order = np.lexsort((due, self._cheapness[rows]))
            best, rest = order[: most // 2], np.sort(order[most // 2 :])
            soonest = rest[np.argsort(due[rest], kind="stable")[: most - len(best)]]
            rows = rows[np.sort(np.concatenate((best, soonest)))]
        return [self._streams[row] for row in rows.tolist()]

    def all(self, now: float) -> list[Stream]:
        """Return all streams that compete, by robot and key."""
        return [self._streams[row] for row in self._rows(now).tolist()]

    def competes(self, now: float, stream: Stream) -> bool:
        """Whether more of the stream is worth anything to somebody, and more is to be expected.

        How long it is silent only its robot's news tells.
        """
        if stream.last is None or stream.schedule.over(self._staleness.reported_until(stream.robot, now)):
            return False
        return len(self._subscribers.gaining(stream)) > 0

    def _rows(self, now: float) -> Rows:
        """Return the rows that compete. How long a stream is silent only its robot's news tells."""
        self._renew()
        until = np.array(self._staleness.all_reported_until(self._robots, now))
        return np.flatnonzero((until[self._owner] - self._last < self._patience) & self._wanted)

    def _renew(self) -> None:
        """Work out anew the rows of streams of which something was noted, or all rows when a change concerns all."""
        if self._revision != self._table.revision:
            self._revision = self._table.revision
            self._set_rows(sorted(self._table, key=lambda stream: (stream.robot, stream.key)))
        for row, (stream, seen) in enumerate(zip(self._streams, self._seen, strict=True)):
            if stream.changes != seen:
                self._look(row, stream)

    def _set_rows(self, streams: list[Stream]) -> None:
        count = len(streams)
        self._streams = streams
        self._row = {(stream.robot, stream.key): row for row, stream in enumerate(streams)}
        self._seen = [-1] * count
        self._robots = sorted({stream.robot for stream in streams})
        places = {robot: place for place, robot in enumerate(self._robots)}
        self._owner = np.array([places[stream.robot] for stream in streams], dtype=np.intp)
        self._wanted = np.zeros(count, dtype=np.bool_)
        self._cheapness, self._last, self._patience, self._next = np.zeros((4, count))

    def _look(self, row: int, stream: Stream) -> None:
        """Take in what there is to know of a stream: `_cheapness` is what a byte of it is worth, negated."""
        self._seen[row] = stream.changes
        last = stream.last
        gaining = 0 if last is None else len(self._subscribers.gaining(stream))
        self._wanted[row] = gaining > 0
        self._last[row], self._patience[row], self._next[row] = stream.schedule.prospect()
        if last is not None:
            self._cheapness[row] = -last.scale * gaining / max(last.size * self._subscribers.copies(stream), 1)
