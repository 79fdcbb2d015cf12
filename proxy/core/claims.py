"""Who sends first where several robots would send before news of one could reach the others: whose claim is best.

A claim grows until its stream sends, and what others know of that is never newer than what its robot knows. So they
take a claim for better than it is, if anything, and no two robots both find their own the best.

Plans leave out what a lesser claim may just have had sent: four robots with cameras whose news took 100 ms filled 15 %
of 1 Mbit/s, as each took the others' frames for sent, and fill 73 to 78 % now. What a better claim may just have had
sent counts as taken until it is known what became of it: five robots with samples of random sizes exceeded the limit
in 5 to 9 % of their windows where a sample gave way only once, and do so in 0.4 to 4 %.
"""

import math
from collections.abc import Sequence

from proxy.core.disputes import Disputes
from proxy.core.limits import Limit, use_of
from proxy.core.prices import Standing
from proxy.core.schedules.patterns import MEMORYLESS
from proxy.core.stream import Stream
from proxy.core.view import SharedView

DECIDED = 0.01
"""What is decided elsewhere is on its way so much later than generated [s]."""
CAUTION = 0.3
"""What generates at random counts as taken by this power of the probability that it did. Five robots with samples of
random sizes reached 94.6 to 97.1 % of a central decider with 0.6 to 2.5 % of windows over at 0.25, 95.3 to 97.8 with
1.3 to 3.0 at 0.3, and 95.6 to 98.8 with 2.1 to 3.4 at 0.5 (four seeds; 20 and 100 ms, unicast and broadcast)."""

Claim = tuple[float, str]
"""What a byte of a stream is worth by how long nothing of it was sent; of equal ones the robot's name tells."""


def news_take(view: SharedView) -> float:
    """Return how long it takes until we have heard what became of a sample of another robot [s]."""
    return view.longest_way + DECIDED


def rivals(
    now: float, view: SharedView, disputes: Disputes, stream: Stream, limits: tuple[Limit, ...]
) -> tuple[float, ...]:
    """Return what samples of others with a better claim than ours of a stream use that may be sent about now."""
    ours, news, taken = claim(now, stream), news_take(view), (0.0,) * len(limits)
    for each in view.competition.all(now):
        better = each.robot != stream.robot and claim(now, each) > ours
        contested = better and disputes.weighed(each).standing is Standing.CONTESTED
        if contested and (part := _taken(now, each, news)) > 0.0:
            use = use_of(round(each.mean_size), view.copies(each), limits, own=False)
            taken = both(taken, [part * amount for amount in use])
    return taken


def claim(now: float, stream: Stream) -> Claim:
    """Return the claim of a stream."""
    since = now - (stream.began if stream.sent is None else stream.sent.t_sent)
    return stream.newest.scale * since / max(1.0, stream.mean_size), stream.robot


def both(one: Sequence[float], other: Sequence[float]) -> tuple[float, ...]:
    """Return what two messages use together."""
    return tuple([a + b for a, b in zip(one, other, strict=True)])


def _taken(now: float, stream: Stream, news: float) -> float:
    """Return what part of a sample of another robot counts as sent, as we cannot have heard of it yet."""
    if stream.schedule.kind == MEMORYLESS:
        return float((-math.expm1(-news / stream.schedule.period)) ** CAUTION)
    return float(_due_unheard(now, stream, news))


def _due_unheard(now: float, stream: Stream, news: float) -> bool:
    """Whether a sample of another robot was due so shortly ago that we cannot have heard what became of it.

    Or will be so soon that its robot cannot have heard of what we send now: where that did not count, robots with
    cameras exceeded the limit in up to 2.4 % of their windows (four, 20 ms; now none) and 2.8 % (eight, 5 ms; now 1.4).
    """
    due = stream.schedule.forecast(now - news, now + max(stream.schedule.jitter, news), 1, now)
    return bool(due) and (stream.sent is None or stream.sent.t_gen < due[0] - 0.5 * stream.schedule.period)
