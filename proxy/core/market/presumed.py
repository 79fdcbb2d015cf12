"""Robots of which little is known are presumed to send as we do: small samples, as often as ours.

They bid with us where we weigh our own streams, and what they lack of our use is booked. Without bidders twelve robots
with small samples alone filled the first windows to 1.9 limits, each at the price of the few that it knew of.
"""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from typing import NamedTuple, Self

from proxy.core.market.standing import Amounts, Row, interval_of, rate_known
from proxy.core.market.tuning import TUNING
from proxy.core.model.limits import Limit, shortest_window
from proxy.core.view.stream import Stream
from proxy.core.view.streams import PLAIN
from proxy.core.view.view import SharedView


def untold(now: float, view: SharedView, others: Iterable[tuple[Row, float]], limits: Sequence[Limit]) -> Amounts:
    """Return what streams of others, each with how far apart it sends [s], use of each limit that nobody told of yet.

    In a window that ends now.
    """
    rates = [(row.use, time, now - view.staleness.known_until(now, row.stream)) for row, time in others]
    return tuple(
        [sum([use[k] / time * min(c.window, since) for use, time, since in rates]) for k, c in enumerate(limits)]
    )


class Presumed(NamedTuple):
    """Robots of which little is known, beside us, under these limits."""

    me: str
    limits: tuple[Limit, ...]
    robots: Sequence[str] = ()

    @classmethod
    def of(cls, now: float, view: SharedView, streams: Iterable[Stream], limits: tuple[Limit, ...]) -> Self:
        """Return those that were met lately, and those of which news are so late that nobody knows their rates.

        Not one that says in time that nothing is new, nor a plain node, which says nothing: they may send little else.
        Nor one that we overhear: what of a stream we did not hear it dropped, and had no word left to say so. Eight
        unequal robots that broadcast reach 96 % of a central decider so, not 89.
        Twelve robots that may tell 1.3 kB/s had 65 % of the windows over the limit without it, and 1 % with it.
        """
        me, window = view.settings.robot, shortest_window(limits)
        robots = {
            stream.robot
            for stream in streams
            if not (stream.robot == me or stream.robot.startswith(PLAIN))
            and not rate_known(now, stream, window)
            and not view.subscribers.overhears(stream.robot)
            and now > view.staleness.known_until(now, stream) + TUNING.untold * interval_of(now, stream, window)
        }
        words_take = view.words_take(view.members.speaking + 1)
        robots.update(peer.robot for peer in view.newcomers.little_known(now, words_take))
        return cls(me, limits, sorted(robots))

    def bidders(self, now: float, rows: Sequence[Row], small: float) -> list[Row]:
        """Return our small streams once more for each of them, as much less often as it is known to send such itself.

        Not for one of which each small stream is known: it differs from us; nor where that are very many. `small` is
        the part of every limit that small messages take at most.
        """
        if not self.robots:
            return []
        window, known, unknown = shortest_window(self.limits), set[str](), set[str]()
        ours, rates = list[Row](), defaultdict[str, float](float)
        for row in rows:
            robot, is_small = row.stream.robot, row.takes_at_most(small, self.limits)
            if rate_known(now, row.stream, window):
                known.add(robot)
            elif is_small:
                unknown.add(robot)
            if is_small:
                rates[robot] += self._rate(row)
                if robot == self.me:
                    ours.append(self._as_others(row))
        found, most = list[Row](), rates[self.me]
        if len(ours) * len(self.robots) > TUNING.bids:
            return []
        for robot in self.robots:
            lacking = most - rates[robot]
            if lacking > TUNING.needless * most and robot not in known - unknown:
                found += [row._replace(interval=row.interval * most / lacking) for row in ours]
        return found

    def lacking(self, load: Sequence[Row], apart: Sequence[float]) -> Amounts:
        """Return what they use of each limit in a window beside what is known of them, if they are as we.

        Of the streams of all that are booked each sends so far apart [s]. Eight robots that met had 20 to 40 % of the
        first 6 s of windows over the limit without it, 1 to 5 % with it.
        """
        windows = [c.window for c in self.limits]
        return self.beside(
            (row.stream.robot, [use * window / interval for use, window in zip(row.use, windows, strict=True)])
            for row, interval in zip(load, apart, strict=True)
        )

    def beside(self, taken: Iterable[tuple[str, Sequence[float]]]) -> Amounts:
        """Return what they take of each limit beside what is known, if they take what we do: of streams, by robot."""
        uses = {robot: [0.0] * len(self.limits) for robot in (self.me, *self.robots)}
        for robot, amounts in taken:
            if (use := uses.get(robot)) is not None:
                for k, amount in enumerate(amounts):
                    use[k] += amount
        ours = uses[self.me]
        each = [[max(0.0, o - t) for o, t in zip(ours, uses[robot], strict=True)] for robot in self.robots]
        return tuple([sum(use[k] for use in each) if c.shared else 0.0 for k, c in enumerate(self.limits)])

    def _rate(self, row: Row) -> float:
        """Return what part of a shared limit the samples of a stream take in a window, at most."""
        parts = [use * c.window / c.limit for use, c in zip(row.use, self.limits, strict=True) if c.shared]
        return max(parts, default=0.0) / row.interval

    def _as_others(self, row: Row) -> Row:
        """Return a stream of ours as if another robot had it: it uses nothing of what is ours alone."""
        use, deviation = (
            tuple([amount if c.shared else 0.0 for amount, c in zip(amounts, self.limits, strict=True)])
            for amounts in (row.use, row.deviation)
        )
        return row._replace(use=use, deviation=deviation)
