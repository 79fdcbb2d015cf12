"""What is disputed: which streams the tree decides on, and what the others are booked for.

What undisputed and priced streams use in a window is booked as load, the *reserve*: contested messages compete for the
rest of each limit, and wait for what we sent to leave the window (`room.py`). With a camera of 26 kB beside small
streams one decider filled 82 % of 1 Mbit/s for one robot and 90 for four so, and 68 and 11 with trees of all streams.
"""

import math
import operator
from collections import defaultdict, deque
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from proxy.core.market.presumed import Presumed, untold
from proxy.core.market.room import at_pace, pace_part
from proxy.core.market.standing import (
    UNKNOWN,
    Amounts,
    Row,
    Standing,
    UnderWay,
    Weighed,
    count_new,
    load_of,
    reserve,
    rows_of,
)
from proxy.core.market.tuning import TUNING
from proxy.core.model.lifetimes import half_life
from proxy.core.model.limits import Limit, Send, longest_window, use_of
from proxy.core.model.waiting import Waiting
from proxy.core.view.stream import Place, Sent, Stream, excess
from proxy.core.view.view import SharedView

if TYPE_CHECKING:
    from proxy.core.market.prices import Market

_Sends = tuple[list[Send], list[Send]]
"""Of others, and of us."""


class Disputes:
    """How the streams of a view stand."""

    def __init__(self, view: SharedView) -> None:
        self._view = view
        self.weighed_at = -math.inf
        """When it was weighed how streams stand [s]."""
        self.revision = 0
        """How often it was weighed how streams stand."""
        self.due_at = math.inf
        """When it is to be weighed again, as samples come so often that the next one will ask for it [s]."""
        self._limits: tuple[Limit, ...] = ()
        self._alone = False
        self._generated: dict[Place, int] = {}
        """How many samples streams had generated then, whether they have a turn or not."""
        self._weighed: dict[Place, Weighed] = {}
        self._waiting: frozenset[Place] = frozenset()
        """Those whose messages are larger than our part and wait for a turn.

        Plans that counted on sending them let no smaller ones go: of twelve robots three were silent for 16 s, none 5.
        """
        self._market: Market | None = None
        self._new = 1
        """So many of the streams that compete are new."""
        self._load: tuple[tuple[Stream, int], ...] = ()
        """The streams that are booked, and in how many copies their samples go."""
        self.booked: Amounts = ()
        """What of each limit is booked in a window."""
        self._known: tuple[float, int, int] | None = None
        self._known_use: Amounts | None = None
        self._known_sends: _Sends = [], []
        """The sends of what is booked, as they are after so many sends noted at that time: one event asks often."""
        self._sends_of: dict[int, tuple[Sent, list[Send]]] = {}
        """Those of each of them, by its place, as they are since it sent this."""
        self.beside: Amounts = ()
        """What of each limit is used in a window beside contested messages if all that is booked is sent.

        A little of what is priced goes at any price: streams worth 100 times as much as that, with samples larger than
        a limit, sent 2 of them in 30 s where only what is booked was kept free, and send 30.
        """
        self.sent: Amounts = ()
        """What of each limit all that is no decision uses in a window in the mean, whatever contested messages need."""
        self.contested: tuple[tuple[Amounts, Amounts], ...] = ()
        """What samples of each contested stream use, and by how much that varies."""
        self.settled: frozenset[Place] = frozenset()
        """The streams that are no part of any decision."""
        self.under_way = UnderWay()
        """What others send of what is booked."""
        self.late = 0.0
        """How much later than it was generated a contested sample may be sent [s]."""
        self.stretched = 0.0
        """How much longer than planned it may take to send several, one after the other [s]."""

    def advance(
        self,
        now: float,
        limits: tuple[Limit, ...],
        *,
        alone: bool,
        turns: bool = False,
        deciding: Stream | None = None,
        rates: Callable[[float], Amounts] | None = None,
    ) -> None:
        """Weigh the streams that compete for these limits, ours `alone` or those of all, if it is time to.

        They may use so much of each in a second by now: these `rates`, if known, else the limits' own.
        Without those that are larger, if these take `turns`. Sooner for the one `deciding`, if it is new, or generated
        half as many then.
        """
        new = deciding is not None and self._knew_little(deciding)
        pause = TUNING.interval_each * len(self._weighed)
        due_at = self.weighed_at + (pause if new else max(TUNING.interval, pause))
        if now < due_at and (self._limits, self._alone) == (limits, alone):
            if now > self.weighed_at and not new:
                self.due_at = due_at
            return
        self.due_at = math.inf
        view, self.weighed_at, self._limits, self._alone = self._view, now, limits, alone
        competing = view.contention.all(now, view.settings.robot if alone else None)
        self._generated = {stream.place: stream.generated for stream in competing}
        self._new = count_new(now, competing, limits)
        rows = rows_of(now, view, view.audiences, competing, limits, new=self._new) if limits else []
        self._waiting = frozenset([row.stream.place for row in rows if turns and not row.has_room(limits)])
        if self._waiting:
            rows = [row for row in rows if row.stream.place not in self._waiting]
        presumed = Presumed(view.settings.robot, limits) if alone else Presumed.of(now, view, competing, limits)
        self._market, weighed = None, list[Weighed]()
        if rows:
            weighed = self._weigh(now, rows, presumed, rates(now) if rates else ())
        self._weighed = {row.stream.place: w for row, w in zip(rows, weighed, strict=True)}
        self.revision += 1
        self._book(list(zip(rows, weighed, strict=True)), presumed)

    def _weigh(self, now: float, rows: Sequence[Row], presumed: Presumed, offered: Amounts) -> list[Weighed]:
        """Return how streams stand at the prices of so much `offered` of each limit in a second.

        What others do not know they do not bid against: only our own streams stand beside presumed bidders.
        """
        from proxy.core.market.prices import Market

        limits, horizon = self._limits, self._view.settings.horizon
        self._market, steady = Market.of(rows, limits, horizon, offered)
        weighed = self._market.weigh(rows, steady)
        if bidders := presumed.bidders(now, rows, self._market.small):
            every = [*rows, *bidders]
            self._market, steady = Market.of(every, limits, horizon, offered)
            own = self._market.weigh(every, steady)
            weighed = [own[at] if self._own(row.stream) else weighed[at] for at, row in enumerate(rows)]
        return weighed

    def _knew_little(self, stream: Stream) -> bool:
        """Whether far more is known of a stream now than when it was weighed how streams stand."""
        then = self._generated.get(stream.place, 0)
        return then < TUNING.rate_samples and stream.generated >= 2 * then

    def weighed(self, stream: Stream) -> Weighed:
        """Return how a stream stands."""
        return self._weighed.get(stream.place, UNKNOWN)

    def last_prices(self, now: float, limits: tuple[Limit, ...]) -> Amounts | None:
        """Return what a unit of each limit cost when streams were weighed last; None: long ago, or other limits."""
        named = [limit.name for limit in limits]
        if self.weighed_at < now - TUNING.known or [limit.name for limit in self._limits] != named:
            return None
        return (0.0,) * len(limits) if self._market is None else self._market.prices

    def standing(self, now: float, stream: Stream, sample: Waiting) -> Standing:
        """Return how a sample of ours stands: undisputed, contested or hopeless."""
        known = self._weighed.get(stream.place) or self._weighed_alone(now, stream)
        if abs(known.scale - sample.scale) > TUNING.alike * known.scale:
            return Standing.CONTESTED
        if known.standing is not Standing.PRICED:
            return known.standing
        due = stream.sent is None or sample.t_gen - stream.sent.t_gen >= known.apart - 0.5 * known.interval
        return Standing.UNDISPUTED if due or known.relieves(excess(stream)) else Standing.HOPELESS

    def _weighed_alone(self, now: float, stream: Stream) -> Weighed:
        """Return how a stream stands that is new, at the prices that there are."""
        market = self._market
        if market is None or market.fits:
            return UNKNOWN
        rows = rows_of(now, self._view, self._view.audiences, [stream], self._limits, new=self._new)
        return market.weigh_new(rows[0])

    def patience(self, stream: Stream, standing: Standing = Standing.CONTESTED) -> float:
        """Return how long a sample that stands so waits for room [s]."""
        if stream.information_type.markovian:
            return TUNING.patience * stream.schedule.period
        if standing is Standing.UNDISPUTED or self.weighed(stream).outweighs:
            # An alarm is not lost because the team sent too much for a moment.
            return max(longest_window(self._limits), half_life(stream.information_type.utility))
        return longest_window(self._limits)

    def left(self, now: float) -> tuple[Amounts, Amounts]:
        """Return what of each limit is left to contested messages, and how long its window is to them [s]."""
        booked, limits = self._used(now), self._limits
        limit = [
            c.limit - min(max(amount, used), max(amount, TUNING.booked * c.limit))
            for c, amount, used in zip(limits, self.booked, booked, strict=True)
        ]
        return tuple(limit), tuple([self._planned(c.window) for c in limits])

    def _planned(self, window: float) -> float:
        """Return the window of plans: shorter by as much as what they send may be late [s]."""
        return window - min(self.late, TUNING.late_window * window) - min(self.stretched, TUNING.paced_window * window)

    def besides(self, now: float, use: Amounts) -> Amounts:
        """Return the use of a contested message, and beside it what was booked and is not used yet."""
        if len(use) != len(self.booked):
            return use
        free = [max(0.0, amount - used) for amount, used in zip(self.booked, self._used(now), strict=True)]
        return tuple([u + f if u > 0.0 else u for u, f in zip(use, free, strict=True)])

    def unbooked(self, now: float, sends: Sequence[Send], *, own: bool) -> tuple[Send, ...]:
        """Return those of our `own` sends, or of others', within the longest window that were not booked, oldest first.

        They may have left a little after they were decided: small samples of others that did were booked and counted
        once more, and four robots with poses for all used 65 % of a limit instead of 75. Larger teams need that margin.
        """
        late = TUNING.longest_departure if self._view.members.speaking <= TUNING.few_others else 0.0
        booked, left, since = defaultdict[Amounts, deque[float]](deque), [], now - self._reach()
        for t, use in sorted(self._sends(now)[own]):
            booked[use].append(t)
        for t, use in sorted(send for send in sends if send[0] >= since):
            times = booked[use]
            while times and times[0] < t - late:
                times.popleft()
            if times and times[0] <= t:
                times.popleft()
            else:
                left.append((t, use))
        return tuple(left)

    def _book(self, rows: Sequence[tuple[Row, Weighed]], presumed: Presumed) -> None:
        """Book what is no decision, and beside that what robots of which little is known may send."""
        limits = self._limits
        contested = [row for row, w in rows if w.standing is Standing.CONTESTED]
        load, apart = load_of(rows)
        self._load = tuple([(row.stream, self._view.subscribers.copies(row.stream)) for row in load])
        self._known, self._sends_of = None, {}
        booked = reserve(load, apart, limits)
        others = [(row, time) for row, time in zip(load, apart, strict=True) if not self._own(row.stream)]
        self.under_way = UnderWay.of(others, len(limits))
        lacking = presumed.lacking(load, apart)
        # Room is kept for contested messages, but not what others use of it that nobody can see.
        unseen = map(operator.add, untold(self.weighed_at, self._view, others, limits), lacking)
        kept = [
            max(
                (r.use[k] - TUNING.smaller_deviations * r.deviation[k] for r in contested if r.use[k] <= c.limit),
                default=0.0,
            )
            for k, c in enumerate(limits)
        ]
        self.booked = tuple(
            [
                min(amount + more, TUNING.booked * c.limit, max(c.limit - keep, least))
                for amount, more, c, keep, least in zip(booked, lacking, limits, kept, unseen, strict=True)
            ]
        )
        self.sent = reserve(load, apart, limits, deviations=0.0)
        every = reserve(load, [row.interval for row in load], limits)
        self.beside = tuple(
            [
                max(amount, min(more, TUNING.booked * c.limit))
                for amount, more, c in zip(self.booked, every, limits, strict=True)
            ]
        )
        self.contested = tuple([(row.use, row.deviation) for row in contested])
        settled = (place for place, w in self._weighed.items() if w.standing is not Standing.CONTESTED)
        self.settled = self._waiting.union(settled)
        periods = [row.interval for row in contested if row.stream.information_type.markovian]
        few = len({row.stream.robot for row in contested}) <= TUNING.late_robots
        self.late = TUNING.late_period * min(periods, default=0.0) if few else 0.0
        own = [] if self._alone else [row for row in contested if self._own(row.stream)]
        largest = max(own, key=lambda row: at_pace(row.use, limits), default=None)
        self.stretched = 0.0
        if largest is not None:
            occupies = pace_part(self._view, largest.stream, limits) * at_pace(largest.use, limits)
            self.stretched = TUNING.paced_ahead * occupies

    def _used(self, now: float) -> Amounts:
        """Return what was sent of what is booked in the windows that end now."""
        others, own = self._sends(now)
        if self._known_use is None:
            self._known_use = tuple(
                [sum(use[k] for t, use in (*others, *own) if t >= now - c.window) for k, c in enumerate(self._limits)]
            )
        return self._known_use

    def _sends(self, now: float) -> _Sends:
        """Return the sends of others' streams that are booked, and of ours, within the longest window."""
        known = now, self._view.traffic.revision, self._view.traffic.messages
        if self._known == known:
            return self._known_sends
        found: _Sends = [], []
        since, known_of = now - self._reach(), self._sends_of
        for place, (stream, copies) in enumerate(self._load):
            if stream.sent is None or stream.sent.t_sent < since:
                continue
            of = known_of.get(place)
            if of is None or of[0] is not stream.sent:
                of = known_of[place] = stream.sent, self._recent_sends(stream, copies, since)
            found[self._own(stream)].extend([send for send in of[1] if send[0] >= since])
        self._known, self._known_sends, self._known_use = known, found, None
        return found

    def _reach(self) -> float:
        """Return for how long sends count, in windows that may be stretched [s]."""
        return self._view.traffic.remembered(longest_window(self._limits))

    def _recent_sends(self, stream: Stream, copies: int, since: float) -> list[Send]:
        """Return what a stream sent since then, the newest first."""
        limits, own, alike, found = self._limits, self._own(stream), dict[int, Amounts](), list[Send]()
        for sent in reversed(stream.recent):
            if sent.t_sent < since:
                break
            use = alike.get(sent.size)
            if use is None:
                use = alike[sent.size] = use_of(sent.size, copies, limits, own=own)
            found.append((sent.t_sent, use))
        return found

    def _own(self, stream: Stream) -> bool:
        return stream.robot == self._view.settings.robot
