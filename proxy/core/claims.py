"""Who sends first where two robots would send in the same moment: news of neither could reach the other in time.

Each robot knows about when samples of the others were due. What a sample of another robot with a better claim takes,
that may just have been sent, counts as taken until it is known what became of it. In a flight of four robots with
cameras 3.4 % of windows were over before, and none after: a frame too many leaves small samples no room for half a
second.
"""

from collections.abc import Sequence

from proxy.core.disputes import Disputes
from proxy.core.limits import Limit, use_of
from proxy.core.prices import Standing
from proxy.core.stream import Stream
from proxy.core.view import SharedView

DECIDED = 0.01
"""What is decided elsewhere is on its way so much later than generated [s]."""


def news_take(view: SharedView) -> float:
    """Return how long it takes until we have heard what became of a sample of another robot [s]."""
    return view.longest_way + DECIDED


def rivals(
    now: float, view: SharedView, disputes: Disputes, stream: Stream, limits: tuple[Limit, ...]
) -> tuple[float, ...]:
    """Return what samples of others use that may just have been sent, and have a better claim than ours of a stream."""
    ours, news, taken = _claim(now, stream), news_take(view), (0.0,) * len(limits)
    for each in view.competition.all(now):
        better = each.robot != stream.robot and _claim(now, each) > ours
        if better and disputes.weighed(each).standing is Standing.CONTESTED and _just_due(now, each, news):
            taken = both(taken, use_of(round(each.mean_size), view.copies(each), limits, own=False))
    return taken


def both(one: Sequence[float], other: Sequence[float]) -> tuple[float, ...]:
    """Return what two messages use together."""
    return tuple([a + b for a, b in zip(one, other, strict=True)])


def _claim(now: float, stream: Stream) -> tuple[float, str]:
    """What a byte of a stream is worth by how long nothing of it was sent; of equal ones the robot's name tells."""
    since = now - (stream.began if stream.sent is None else stream.sent.t_sent)
    return stream.newest.scale * since / max(1.0, stream.mean_size), stream.robot


def _just_due(now: float, stream: Stream, news: float) -> bool:
    """Whether a sample of another robot was due so shortly ago that we cannot have heard what became of it."""
    due = stream.schedule.forecast(now - news, now + stream.schedule.jitter, 1, now)
    return bool(due) and (stream.sent is None or stream.sent.t_gen < due[0] - 0.5 * stream.schedule.period)
