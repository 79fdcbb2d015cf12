"""Who competes for the channel: the streams of which more is worth anything to somebody, and is to be expected.

A large team has far more streams than a window has places, and most streams have not changed since the last decision.
So what is asked of streams is kept in rows, and worked out anew only for streams of which something was noted since.
"""

from bisect import bisect_left
from collections import Counter
from collections.abc import Container
from typing import Any

from proxy.core.view.staleness import Staleness
from proxy.core.view.stream import Stream, at_stake
from proxy.core.view.streams import Place, Streams, Turn
from proxy.core.view.subscribers import Subscribers


class Contention:
    """The streams of a view as rows, by robot and key, so that a row's number orders it among equals."""

    def __init__(self, streams: Streams, subscribers: Subscribers, staleness: Staleness) -> None:
        self._table = streams
        self._subscribers = subscribers
        self._staleness = staleness
        self._revision = self._revisions = -1
        self._known: tuple[list[float], list[int]] = [], []
        """Until when robots had told of themselves when rows were looked for last [s], and those that compete."""
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
        changed = self._renew()
        told = self._staleness.all_reported_until(self._robots, now)
        if not changed and told == self._known[0]:  # a decision asks twice
            return self._known[1]
        until = dict(zip(self._robots, told, strict=True))
        rows = zip(self._streams, self._wanted, self._last, self._patience, strict=True)
        found = [
            row
            for row, (stream, wanted, last, patience) in enumerate(rows)
            if wanted and until[stream.robot] - last < patience
        ]
        self._known = told, found
        return found

    def _renew(self) -> bool:
        """Work out anew the rows of streams of which something was noted, or all rows when a change concerns all.

        Where only streams came or went the others keep their rows: two thousand keys that came one by one took a core
        22 s where each had all rows put in order anew. Return whether any row is another one.
        """
        changed = self._revision != self._table.revision
        if self._revision != self._table.revision:
            turns = self._table.turns_since(self._revision, self._revisions)
            if turns is None:
                self._set_rows(sorted(self._table, key=_place))
            for turn in turns or ():
                self._turn(turn)
            self._revision, self._revisions = self._table.revision, self._table.revisions
        for row, (stream, seen) in enumerate(zip(self._streams, self._seen, strict=True)):
            if stream.changes != seen:
                self._look(row, stream)
                changed = True
        return changed

    def _set_rows(self, streams: list[Stream]) -> None:
        """Have a row for each stream."""
        count = len(streams)
        self._streams = streams
        self._places = [_place(stream) for stream in streams]
        self._count = Counter(stream.robot for stream in streams)
        self._robots = sorted(self._count)
        self._seen = [-1] * count
        self._wanted = [False] * count
        self._cheapness, self._last, self._patience, self._next = ([0.0] * count for _ in range(4))

    def _turn(self, turn: Turn) -> None:
        """A stream came, or went."""
        place, row, robot = turn.place, bisect_left(self._places, turn.place), turn.place[0]
        columns: tuple[tuple[list[Any], Any], ...] = (
            *((self._places, place), (self._streams, turn.stream), (self._seen, -1), (self._wanted, False)),
            *((column, 0.0) for column in (self._cheapness, self._last, self._patience, self._next)),
        )
        for column, value in columns:
            if turn.there:
                column.insert(row, value)
            else:
                del column[row]
        self._count[robot] += 1 if turn.there else -1
        if not self._count[robot]:
            del self._count[robot]
        self._robots = sorted(self._count)

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


def _place(stream: Stream) -> Place:
    return stream.robot, stream.key
