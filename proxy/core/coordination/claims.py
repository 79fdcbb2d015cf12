"""Who sends first where several robots would send before news of one could reach the others: whose claim is best.

A claim is what a receiver gains by a sample over the one it has, for as long again as it has had that, and a part of
its own worth (without that, streams that send often are 20 % too often before others). It grows until its stream sends,
but no longer than samples last, and what others know of it is never newer than what its robot knows: no two robots both
find their own the best. What never sent has the greatest that it may have; of equal ones the name decides.

The best claim waits for the room that any robot leaves; the others leave it that (four robots: 2 % more bytes, eight
3).

Plans leave out what a lesser claim may just have had sent: four robots with cameras whose news took 100 ms fill 73 to
78 % of 1 Mbit/s, where each took the others' frames for sent 15. What a better claim may have had sent counts as taken
until it is known what became of it, and so on down the claims: windows over the limit fell from 5 to 9 % to 0.4 to 4
(five robots, random sizes). Not where that is known less well than news take: one such stream held up all behind it (81
to 87 % of a central decider, 90 to 96 now). Who sent last counts until all can know of it (3.2 to 6.4 % of windows
over, 1.0 to 1.9 now). Who gave way for longer than others count a sample gives way to worse claims, too (4.1 % over,
0.5).

Nobody gives way where large samples are seldom and overheard, as all plans agree then (`Team.agrees`): 2 to 5 % more
utility. Nor to a stream that earns far less than its room costs, as no plan sends it: twelve robots, of whose streams
one in three paid, reach 70 to 91 % of a central decider instead of 28 to 52.

A contested stream gives way to contested ones alone. Priced ones send now and then in room that is booked for them, and
their claims grow for as long: nobody led, and five of eight robots never sent a large sample (72 % of a central
decider, 83 now). All but the best claim hold up nobody where they find no room: twelve robots with three streams each
reached 88 % without that, and reach 98.
"""

import math
from collections.abc import Callable, Sequence
from operator import itemgetter

from planner.utility import integral
from proxy.core.coordination.tuning import TUNING
from proxy.core.forecast.patterns import MEMORYLESS
from proxy.core.market.disputes import Disputes
from proxy.core.market.standing import Standing
from proxy.core.model.limits import Limit, changes_plans, use_of
from proxy.core.view.stream import Stream, excess
from proxy.core.view.view import SharedView
from utility_specs.lifetimes import initial

Claim = tuple[float, str]
"""What a byte of a stream gains by how long nothing of it was sent; of equal ones the robot's name tells."""
NOBODY: Claim = -math.inf, ""

CLAIMING = Standing.CONTESTED, Standing.PRICED


def news_take(view: SharedView) -> float:
    """Return how long it takes until we have heard what became of a sample of another robot [s]."""
    return view.staleness.longest_way + view.staleness.delay + TUNING.deciding


class Claims:
    """Which of our streams have the best claim of all, and what those with a better one may send."""

    def __init__(self, view: SharedView, disputes: Disputes) -> None:
        self._view, self._disputes = view, disputes
        self._known: tuple[float, int, tuple[Limit, ...], Standing] = -math.inf, -1, (), Standing.CONTESTED
        """When it was looked at [s], after how many changes of how streams stand, under which limits, and for whom."""
        self._best: Claim = NOBODY

    def lead(self, now: float, stream: Stream, limits: tuple[Limit, ...]) -> bool:
        """Whether a periodic stream of ours has the best claim: the others leave it the room that opens next."""
        if not _waits(stream) or _has_just_resumed(now, stream, self._view):
            return False
        known = now, self._disputes.revision, limits, self._disputes.weighed(stream).standing
        if known != self._known:
            claims = self._of_others(now, stream, limits)
            self._known, self._best = known, max((theirs for theirs, _ in claims), default=NOBODY)
        return self._best == NOBODY or self._best < claim(now, stream)

    def rivals(
        self,
        now: float,
        stream: Stream,
        limits: tuple[Limit, ...],
        grew: Callable[[float, float], float],
        free: Callable[[tuple[float, ...]], Sequence[float]],
        *,
        agreed: bool,
    ) -> tuple[tuple[float, ...], float]:
        """Return what samples of others with a better claim than ours use that may be sent now; none if all `agreed`.

        And until when at least, as far as they are not heard of [s]. The best of them may have waited until the room
        `grew`, or wait until it soon does, when it cannot have heard of us: eight robots with cameras had 1 % of the
        windows over the limit without that, and 0.4 so (no loss, 20 ms). Each may have given way to those before it
        until it was known what became of them. All but the best send nothing that finds no room in what is `free`.
        """
        claims = [] if agreed else self._of_others(now, stream, limits)
        claims = [(theirs, each) for theirs, each in claims if self._pays(each)]
        taken, until = self._taken_by_new(now, stream, limits), math.inf
        if not claims:
            return taken, until
        ours, news = claim(now, stream) if self._pays(stream) else NOBODY, news_take(self._view)
        opened = grew(now, news)
        late = self._is_late(now, stream, opened if all(theirs < ours for theirs, _ in claims) else -math.inf)
        if late or _has_just_resumed(now, stream, self._view):
            ours = NOBODY
        better = sorted([entry for entry in claims if entry[0] > ours], key=itemgetter(0), reverse=True)
        better[1:] = [entry for entry in better[1:] if self._finds_room(entry[1], limits, free)]
        last = max((each.sent.t_sent for _, each in claims if each.sent is not None), default=-math.inf)
        decided = min(last, now) + news
        for rank, (_, each) in enumerate(better):
            if _waits(each):
                since = _due(now, each, news)
                if since == -math.inf:
                    continue
                since = self._room_since(since, opened, each) if rank == 0 else since
                spread = _spread(now, each)
                known = math.inf if spread <= news else -math.inf  # whether it is known when it decides
                ends = max(since, min(decided, known)) + news + spread
                decided, part = max(decided, min(ends, known)), float(now < ends)
                size = max(each.sizes.mean, each.sizes.announced) + TUNING.larger_deviations * each.sizes.deviation
            else:
                ends, size = now + news, each.sizes.mean
                back = news * (TUNING.undecided_news if rank else 1.0)
                part = float((-math.expm1(-back / each.schedule.period)) ** TUNING.caution)
            if part > 0.0:
                use = use_of(round(size), self._view.subscribers.copies(each), limits, own=False)
                taken, until = both(taken, [part * amount for amount in use]), min(until, ends)
        return taken, until

    def _room_since(self, since: float, grew: float, stream: Stream) -> float:
        """Return from when a sample has room that came then, or later as the room `grew` while it waited [s]."""
        if since < grew < since + self._disputes.patience(stream):
            return grew + opening(self._view) + self._view.staleness.delay
        return since

    def _is_late(self, now: float, stream: Stream, grew: float) -> bool:
        """Whether others take the fate of our newest sample for known, which waited for the room that `grew`."""
        since = self._room_since(stream.newest.t_gen, grew, stream)
        return _waits(stream) and now > since + news_take(self._view) + _spread(now, stream)

    def _of_others(self, now: float, stream: Stream, limits: tuple[Limit, ...]) -> list[tuple[Claim, Stream]]:
        """Return the contested large streams of other robots, with their claims as these are compared with ours.

        Priced ones only where ours is one, too: they have a booked room of their own.
        """
        view, weighed = self._view, self._disputes.weighed
        claiming = CLAIMING[:1] if weighed(stream).standing is Standing.CONTESTED else CLAIMING
        later = now + TUNING.claim_tolerance
        return [
            (claim(later if each.robot > stream.robot else now, each), each)
            for each in view.contention.all(now)
            if each.robot != stream.robot and weighed(each).standing in claiming and is_large(each, view, limits)
        ]

    def _finds_room(
        self, stream: Stream, limits: tuple[Limit, ...], free: Callable[[tuple[float, ...]], Sequence[float]]
    ) -> bool:
        """Whether one of the smaller samples of another robot's stream finds room in what is `free` for such."""
        size = stream.sizes.mean - TUNING.larger_deviations * stream.sizes.deviation
        use = use_of(max(1, round(size)), self._view.subscribers.copies(stream), limits, own=False)
        return all(amount <= room for amount, room in zip(use, free(use), strict=True))

    def _pays(self, stream: Stream) -> bool:
        """Whether a sample of a stream may well pay for the room it takes, if not every one."""
        weighed, sizes = self._disputes.weighed(stream), stream.sizes
        least = max(sizes.mean - sizes.deviation, 0.0) / max(sizes.mean, 1.0)
        return weighed.most >= TUNING.claim_pays * least * weighed.cost

    def _taken_by_new(self, now: float, stream: Stream, limits: tuple[Limit, ...]) -> tuple[float, ...]:
        """Return what those may send about now of whose large streams only the states tell; what never sent goes first.

        Of eight robots that met two sent at once in 10 % of the windows of the first 6 s, and do so in 3.5.
        """
        taken = (0.0,) * len(limits)
        first = [
            peer
            for peer in self._view.newcomers.met_lately(now)
            if stream.sent is not None or peer.robot > stream.robot
        ]
        for peer in first:
            for key, told in peer.told.items():
                known = self._view.streams.known(peer.robot, key)
                if known is None or known.last is None:
                    use = use_of(told.size, self._view.subscribers.copies_of(peer.robot, key), limits, own=False)
                    taken = both(taken, use) if changes_plans(use, limits) else taken
        return taken


def opening(view: SharedView) -> float:
    """Return how much later than it seems room opens that others leave [s]: how long news take is not known better."""
    return TUNING.opening_part * view.staleness.longest_way


def _due(now: float, stream: Stream, news: float) -> float:
    """Return when the newest sample of another robot was due whose fate we have not heard of; −∞: there is none [s].

    Or is due before its robot can have heard of what we send now: without that up to 2.8 % of the windows were over.
    """
    schedule, half = stream.schedule, 0.5 * stream.schedule.period
    soon = now + max(news, min(schedule.uncertainty(now), half))
    due = max(
        schedule.forecast(now - schedule.period - schedule.jitter, soon, TUNING.due_samples, now), default=-math.inf
    )
    if schedule.last is not None and schedule.last > max(now - schedule.period, due - half):
        due = schedule.last  # it was told of, and may wait still
    return due if stream.sent is None or stream.sent.t_gen < due - half else -math.inf


def _spread(now: float, stream: Stream) -> float:
    """Return how much later than it is due a sample of another robot may come [s]."""
    return min(TUNING.late_deviations * stream.schedule.uncertainty(now), TUNING.late_part * stream.schedule.period)


def is_large(stream: Stream, view: SharedView, limits: tuple[Limit, ...]) -> bool:
    """Whether samples of another robot's stream change what others plan."""
    return changes_plans(use_of(round(stream.sizes.mean), view.subscribers.copies(stream), limits, own=False), limits)


def _has_just_resumed(now: float, stream: Stream, view: SharedView) -> bool:
    """Whether others cannot know yet that a stream of ours goes on, which they take to have ceased."""
    resumed = stream.schedule.resumed
    return resumed > -math.inf and now < resumed + news_take(view)


def _waits(stream: Stream) -> bool:
    """Whether it is known when a stream has a sample that may wait for room that others leave."""
    return stream.schedule.kind != MEMORYLESS


def claim(now: float, stream: Stream) -> Claim:
    """Return the claim of a stream: of `current` it gains by what it ends, too.

    What never sent gains all that a sample is worth. Where its claim was the best of all a robot whose samples of 0.4
    limits nobody ever sends held up twelve unequal ones for ever (76 % of a central decider, 91 now).
    """
    since = TUNING.worthless if stream.sent is None else max(0.0, now - stream.sent.t_sent)
    utility, over = stream.information_type.utility, excess(stream)
    anew = integral(utility, since)
    gain = stream.newest.scale * ((1.0 + TUNING.claim_worth) * anew - (integral(utility, 2.0 * since) - anew))
    if over > 0.0:
        gain += over * initial(utility) * since
    return gain / max(1.0, stream.sizes.announced or stream.sizes.mean), stream.robot


def both(one: Sequence[float], other: Sequence[float]) -> tuple[float, ...]:
    """Return what two messages use together."""
    return tuple([a + b for a, b in zip(one, other, strict=True)])


def first_at(now: float, view: SharedView, stream: Stream, limits: tuple[Limit, ...]) -> float:
    """Return when a large stream of ours that has just begun may send, for all that others may do [s]; −∞: now.

    Robots that may begin together send in turn, by the wall clock and their names, so that each hears of those before
    where clocks agree to some milliseconds: eight with cameras filled the first windows to 1.7 to 2.9 limits, and to
    1.0 to 1.4 now (simulation). Four lost small samples in 5 of 24 flights where each counted from its own beginning.
    """
    if now >= stream.began + TUNING.first_time:
        return -math.inf
    sent = {each.robot for each in view.contention.all(now) if each.sent is not None and is_large(each, view, limits)}
    listens = view.newcomers.only_listens
    others = {peer.robot for peer in view.peers.values() if not (peer.plain or listens(peer))}
    if len(others - sent) <= TUNING.first_few:
        return -math.inf
    names = sorted({*others, stream.robot})
    cycle, place, wall = TUNING.first_time, names.index(stream.robot) / len(names), now + view.clocks.offset
    began = (math.floor(wall / cycle - place) + place) * cycle
    if wall < began + TUNING.first_part * cycle / len(names):
        return -math.inf
    return min(began + cycle - view.clocks.offset, stream.began + TUNING.first_time)
