"""Who competes for the channel: in rows, worked out anew only for streams of which something was noted since."""

from collections.abc import Container
from operator import attrgetter

from proxy.core.view.peer import Staleness
from proxy.core.view.stream import Stream, at_stake
from proxy.core.view.streams import Streams
from proxy.core.view.subscribers import Subscribers


class _Row:
    """What there is to know of a stream after changes `seen`: a byte's worth, negated, its end and next sample [s]."""

    __slots__ = ("cheapness", "due", "over_at", "seen", "stream", "wanted")

    def __init__(self, stream: Stream) -> None:
        self.stream = stream
        self.seen = -1
        self.wanted = False
        self.cheapness = self.over_at = self.due = 0.0

    def look(self, subscribers: Subscribers) -> None:
        stream, last = self.stream, self.stream.last
        self.seen = stream.changes
        gaining = 0 if last is None else len(subscribers.gaining(stream))
        self.wanted = gaining > 0
        self.over_at, self.due = stream.schedule.prospect()
        if last is not None:
            copies = subscribers.copies(stream)
            self.cheapness = -at_stake(stream, last.scale) * gaining / max(last.size * copies, 1)


class Contention:
    """The streams of a view as rows, by robot and key."""

    def __init__(self, streams: Streams, subscribers: Subscribers, staleness: Staleness) -> None:
        self._table = streams
        self._subscribers = subscribers
        self._staleness = staleness
        self._revision = self._revisions = -1
        self._rows: dict[Stream, _Row] = {}
        """By robot and key."""
        self._robots: frozenset[str] = frozenset()
        self._known: tuple[list[float], list[_Row]] = [], []
        """Until when robots had told of themselves when rows were looked for last [s], and those that compete."""

    def chosen(
        self, now: float, most: int, robot: str | None = None, besides: Container[tuple[str, str]] = ()
    ) -> list[Stream]:
        """Return those streams that compete for which a window of `most` messages has places, by robot and key.

        Half for those worth most per byte on the air, half for those that generate next; of a `robot`, none `besides`.
        """
        rows = self._competing(now)
        if robot is not None:
            rows = [row for row in rows if row.stream.robot == robot]
        if besides:
            rows = [row for row in rows if row.stream.place not in besides]
        if len(rows) > most:
            rows = _ranked(now, most, rows)
        return [row.stream for row in rows]

    def all(self, now: float, robot: str | None = None) -> list[Stream]:
        """Return all streams that compete, or those of a robot, by robot and key."""
        return [row.stream for row in self._competing(now) if robot is None or row.stream.robot == robot]

    def competes(self, now: float, stream: Stream) -> bool:
        """Whether more of the stream is worth anything to somebody, and more is to be expected by its robot's news."""
        if stream.last is None or stream.schedule.over(self._staleness.known_until(now, stream)):
            return False
        return len(self._subscribers.gaining(stream)) > 0

    def _competing(self, now: float) -> list[_Row]:
        """Return the rows that compete. How long a stream is silent only its robot's news tells."""
        changed = self._renew()
        told = [min(now, self._staleness.told_until(robot)) for robot in self._robots]
        if changed or told != self._known[0]:  # a decision asks twice
            until = dict(zip(self._robots, told, strict=True))
            rows = [
                row
                for row in self._rows.values()
                if row.wanted and max(until[row.stream.robot], row.stream.known_until) < row.over_at
            ]
            self._known = told, rows
        return self._known[1]

    def _renew(self) -> bool:
        """Work out anew the rows of streams of which something was noted; return whether any row is another one.

        All rows only where a change concerns all: else 2,000 keys that came one by one took a core 22 s.
        """
        table = self._table
        changed = self._revision != table.revision
        if changed:
            known = self._rows if self._revisions == table.revisions else {}
            self._rows = {each: known.get(each) or _Row(each) for each in sorted(table, key=_place)}
            self._robots = frozenset(stream.robot for stream in table)
            self._revision, self._revisions = table.revision, table.revisions
        for row in self._rows.values():
            if row.stream.changes != row.seen:
                row.look(self._subscribers)
                changed = True
        return changed


_place = attrgetter("robot", "key")


def _ranked(now: float, most: int, rows: list[_Row]) -> list[_Row]:
    """Return `most` of these rows, in order. Of 500 that takes a quarter of what sorting lists would."""
    import numpy as np  # noqa: PLC0415 - a daemon that knows no streams does without

    due = np.maximum(now, np.array([row.due for row in rows]))
    order = np.lexsort((due, np.array([row.cheapness for row in rows])))
    best, rest = order[: most // 2], np.sort(order[most // 2 :])
    soonest = rest[np.argsort(due[rest], kind="stable")[: most - len(best)]]
    return [rows[place] for place in np.sort(np.concatenate((best, soonest)))]
