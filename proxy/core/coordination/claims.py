"""Who sends first where several robots would send before news of one could reach the others: whose claim is best.

A claim is what a receiver gains by a sample over the one it has, for as long again as it has had that, and a part of
what the sample is worth by itself. Where it was all of that, streams that send often went before others too often: of
eight robots with cameras those that saw red sent 20 % more than in the optimum, by the others' rate, and send as much
now, with equal utility; without that part it would be 10 % less (simulation, 6 Mbit/s carried, six seeds). It grows
until its stream sends, and what others know of that is never newer than what its robot knows. So they take a claim for
better than it is, if anything, and no two robots both find their own the best. It grows no longer than samples last:
where it did, streams that no plan sends held back those that all plans send, and ten robots with equal messages of
unequal worth reached 79 % of a central decider (300 ms, broadcast), and reach 96 now.

Whose claim is the best waits for the room that any robot leaves, and the others leave it that: four robots with cameras
sent 2 % more bytes so, and eight 3 %. If all waited several would send at once.

Plans leave out what a lesser claim may just have had sent: four robots with cameras whose news took 100 ms filled 15 %
of 1 Mbit/s, as each took the others' frames for sent, and fill 73 to 78 % now. What a better claim may just have had
sent counts as taken until it is known what became of it: five robots with samples of random sizes exceeded the limit
in 5 to 9 % of their windows where a sample gave way only once, and do so in 0.4 to 4 %. Who has the next best claim may
have given way until then, so what becomes of its sample is known later still, and so on: of eight robots with cameras,
whose news took 8 ms, three sent at one moment now and then (1.3 to 1.4 limits), and 1.4 % of the windows were over the
limit with 1,028 kB sent; now 0.4 %, by 1 %, with 1,046 kB. Not so where it is known less well than news take when a
sample comes: one such stream held up all behind it, and eight robots with two seldom streams each reached 81 to 87 % of
a central decider (broadcast, 2 ms), and reach 90 to 96 now. Who sent last counts until all can know of it, though its
own claim is small then: of ten robots with equal messages two sent at one moment in 3.2 to 6.4 % of the windows, and in
1.0 to 1.9 % now.

All this holds for as long as others count a sample as one that may have been sent. Who gave way until after that, be it
to one whose news it lacked, gives way to worse claims, too, for these do not wait for it any more. Of eight robots with
cameras and small samples two sent at one moment in 4.1 % of the windows, and do so in 0.5 (20 ms, unicast, four seeds),
with 0.1 % less utility and 6 % fewer bytes; ten robots with equal messages that broadcast had 8.5 % of the windows over
the limit where 30 % of all was lost, and have 4.2 (three).

Where large samples come seldom and are overheard nobody gives way: the plans of all say the same of what others may
just have sent (`Team.agrees`), and ten robots with equal messages reach 2 to 5 % more so (most important, 2 to 100 ms),
with 0 to 1 % of the windows over. Where samples wait for the room that others leave it does not do: of eight robots
with cameras and small samples half of the windows were over the limit.

A stream whose samples earn far less than their room costs is sent by no plan, or in the room that all others leave. So
nobody gives way to its claim, which only grows, and it gives way to all that pay. Where it counted the others waited
for such streams by turns: twelve robots with three streams each, of which one paid for its room, reached 28 to 52 % of
a central decider, and reach 70 to 91 now, with no window over the limit (15 s).

A contested stream gives way to contested ones alone: priced ones send now and then in room that is booked for them, and
their claims grow for as long. With large samples that last for half a second, beside small ones that last longer,
nobody led, two of eight robots went on as they had begun, and five never sent a large one; they reached 72 % of a
central decider, and reach 83 now (unicast, 20 ms).

A claim that finds no room in what is free holds up nothing but where it is the best, for which room is left: twelve
robots with three streams each, the largest of 0.4 limits, sent half of what a central decider sent of the others, and
reached 88 % of its utility; now 98 (broadcast, 20 ms).

Of a stream that never sent a receiver has nothing, so its claim is the best. Of two such the name decides: when each
began is known to others from numbers alone, and where they compared that each of two took the other's claim for the
better one, and both waited; where they compared what a byte gains several led, as each knew other sizes. Of eight
robots with cameras and small samples, whose applications began 3 s after the daemons, the last one's first frame went
after 5.2 s in the mean, and goes after 2.6 (one decider: 4.5; four seeds).
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
"""The least claim."""

CLAIMING = Standing.CONTESTED, Standing.PRICED


def news_take(view: SharedView) -> float:
    """Return how long it takes until we have heard what became of a sample of another robot [s]."""
    return view.staleness.longest_way + view.staleness.delay + TUNING.deciding


class Lead:
    """Which of our streams have the best claim of all: what others claim is looked at once for all of them."""

    def __init__(self, view: SharedView, disputes: Disputes) -> None:
        self._view, self._disputes = view, disputes
        self._known: tuple[float, int, tuple[Limit, ...], Standing] = -math.inf, -1, (), Standing.CONTESTED
        """When it was looked at [s], after how many changes of how streams stand, under which limits, and for whom."""
        self._best: Claim = NOBODY
        """The best claim of others then."""

    def has(self, now: float, stream: Stream, limits: tuple[Limit, ...]) -> bool:
        """Whether a periodic stream of ours has the best claim: the others leave it the room that opens next."""
        if not _waits(stream):
            return False
        known = now, self._disputes.revision, limits, self._disputes.weighed(stream).standing
        if known != self._known:
            claims = _claims(now, self._view, self._disputes, stream, limits)
            self._known, self._best = known, max((theirs for theirs, _ in claims), default=NOBODY)
        return self._best == NOBODY or self._best < claim(now, stream)


def opening(view: SharedView) -> float:
    """Return how much later than it seems room opens that others leave [s]: how long news take is not known better."""
    return TUNING.opening_part * view.staleness.longest_way


def rivals(
    now: float,
    view: SharedView,
    disputes: Disputes,
    stream: Stream,
    limits: tuple[Limit, ...],
    *,
    grew: Callable[[float], float],
    free: Sequence[float],
    agreed: bool = False,
) -> tuple[tuple[float, ...], float]:
    """Return what samples of others with a better claim than ours of a stream use that may be sent about now.

    And until when at least, as far as they are not heard of [s]. There are none where all plans are `agreed` on them.
    The best of them may have waited until the room last `grew`, as it is told of a time; each may have given way to who
    sent last, and to those before it, until it was known what became of them. Who finds no room in what is `free` sends
    nothing, but for the best, which room is left for.
    """
    claims = [] if agreed else _claims(now, view, disputes, stream, limits)
    claims = [(theirs, each) for theirs, each in claims if _pays(each, disputes)]
    taken, until = _taken_by_new(now, view, stream, limits), math.inf
    if not claims:
        return taken, until
    ours = claim(now, stream) if _pays(stream, disputes) else NOBODY
    news, opened = news_take(view), grew(now)
    if _is_late(now, view, disputes, stream, grew=opened, leads=all(theirs < ours for theirs, _ in claims)):
        ours = NOBODY
    better = sorted([entry for entry in claims if entry[0] > ours], key=itemgetter(0), reverse=True)
    better[1:] = [entry for entry in better[1:] if _finds_room(entry[1], view, limits, free)]
    last = max((each.sent.t_sent for _, each in claims if each.sent is not None), default=-math.inf)
    decided = min(last, now) + news
    for rank, (_, each) in enumerate(better):
        if _waits(each):
            since = _due(now, each, news)
            if since == -math.inf:
                continue
            if rank == 0 and since < opened < since + disputes.patience(each):
                since = opened + opening(view) + view.staleness.delay
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
            use = use_of(round(size), view.subscribers.copies(each), limits, own=False)
            taken, until = both(taken, [part * amount for amount in use]), min(until, ends)
    return taken, until


def _is_late(now: float, view: SharedView, disputes: Disputes, stream: Stream, *, grew: float, leads: bool) -> bool:
    """Whether others take it for known by now what became of the newest sample of a stream of ours.

    Where it `leads` they leave it the room that `grew` last.
    """
    since = stream.newest.t_gen
    if leads and since < grew < since + disputes.patience(stream):
        since = grew + opening(view) + view.staleness.delay
    return _waits(stream) and now > since + news_take(view) + _spread(now, stream)


def _due(now: float, stream: Stream, news: float) -> float:
    """Return when the newest sample of another robot was due whose fate we have not heard of; −∞: there is none [s].

    Or is due so soon that its robot cannot have heard of what we send now: where that did not count, robots with
    cameras exceeded the limit in up to 2.4 % of their windows (four, 20 ms; now none) and 2.8 % (eight, 5 ms; now 1.4).
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


def _claims(
    now: float, view: SharedView, disputes: Disputes, stream: Stream, limits: tuple[Limit, ...]
) -> list[tuple[Claim, Stream]]:
    """Return the contested streams of other robots that are large, with their claims as these are compared with ours.

    Small ones that are new are soon something else. Priced ones count where ours is one, too: they have a booked room
    of their own.
    """
    contested = disputes.weighed(stream).standing is Standing.CONTESTED
    claiming = CLAIMING[:1] if contested else CLAIMING
    return [
        (_theirs(now, each, stream), each)
        for each in view.contention.all(now)
        if each.robot != stream.robot and disputes.weighed(each).standing in claiming and is_large(each, view, limits)
    ]


def _pays(stream: Stream, disputes: Disputes) -> bool:
    """Whether a sample of a stream may well pay for the room it takes, if not every one."""
    weighed, sizes = disputes.weighed(stream), stream.sizes
    least = max(sizes.mean - sizes.deviation, 0.0) / max(sizes.mean, 1.0)
    return weighed.most >= TUNING.claim_pays * least * weighed.cost


def _finds_room(stream: Stream, view: SharedView, limits: tuple[Limit, ...], free: Sequence[float]) -> bool:
    """Whether one of the smaller samples of another robot's stream finds room in what is free."""
    size = stream.sizes.mean - TUNING.larger_deviations * stream.sizes.deviation
    use = use_of(max(1, round(size)), view.subscribers.copies(stream), limits, own=False)
    return all(amount <= room for amount, room in zip(use, free, strict=True))


def is_large(stream: Stream, view: SharedView, limits: tuple[Limit, ...]) -> bool:
    """Whether samples of another robot's stream change what others plan."""
    return changes_plans(use_of(round(stream.sizes.mean), view.subscribers.copies(stream), limits, own=False), limits)


def _waits(stream: Stream) -> bool:
    """Whether it is known when a stream has a sample that may wait for room that others leave."""
    return stream.schedule.kind != MEMORYLESS


def _taken_by_new(now: float, view: SharedView, stream: Stream, limits: tuple[Limit, ...]) -> tuple[float, ...]:
    """Return what those may send about now of whose large streams only the states tell.

    What never sent goes before what has; of two that did not the name decides. Of eight robots that met in 10 % of the
    windows of the first 6 s two of them sent at once, and do so in 3.5 %.
    """
    taken = (0.0,) * len(limits)
    first = [peer for peer in view.newcomers.met_lately(now) if stream.sent is not None or peer.robot > stream.robot]
    for peer in first:
        for key, told in peer.told.items():
            known, use = view.streams.known(peer.robot, key), use_of(told.size, 1, limits, own=False)
            if (known is None or known.last is None) and changes_plans(use, limits):
                taken = both(taken, use)
    return taken


def claim(now: float, stream: Stream) -> Claim:
    """Return the claim of a stream: of `current` it gains by what it ends, too. What never sent has the best one."""
    if stream.sent is None:
        return math.inf, stream.robot
    since = max(0.0, now - stream.sent.t_sent)
    utility, over = stream.information_type.utility, excess(stream)
    anew = integral(utility, since)
    gain = stream.newest.scale * ((1.0 + TUNING.claim_worth) * anew - (integral(utility, 2.0 * since) - anew))
    if over > 0.0:
        gain += over * initial(utility) * since
    return gain / max(1.0, stream.sizes.announced or stream.sizes.mean), stream.robot


def _theirs(now: float, stream: Stream, ours: Stream) -> Claim:
    """Return the claim of a stream of another robot, as it is compared with that of ours."""
    return claim(now + TUNING.claim_tolerance if stream.robot > ours.robot else now, stream)


def both(one: Sequence[float], other: Sequence[float]) -> tuple[float, ...]:
    """Return what two messages use together."""
    return tuple([a + b for a, b in zip(one, other, strict=True)])
