"""Who sends first where the applications of several robots begin together, and nobody has heard of the others yet.

Who may be about to begin sends one large sample first, in the order of names, so far apart that each hears of those
before: eight robots with cameras filled the first windows to 1.7 to 2.9 limits, and to 1.0 to 1.4 now (simulation).
"""

import math

from proxy.core.coordination.claims import is_large, news_take
from proxy.core.coordination.tuning import TUNING
from proxy.core.model.limits import Limit
from proxy.core.view.stream import Stream
from proxy.core.view.view import SharedView


def first_at(now: float, view: SharedView, stream: Stream, limits: tuple[Limit, ...]) -> float:
    """Return when a large stream of ours that has just begun may send, for all that others may do [s]; −∞: at once."""
    if now >= stream.began + TUNING.first_time:
        return -math.inf
    sent = {each.robot for each in view.contention.all(now) if each.sent is not None and is_large(each, view, limits)}
    silent = [
        peer.robot
        for peer in view.peers.values()
        if peer.robot not in sent and not peer.plain and not view.newcomers.only_listens(peer)
    ]
    if len(silent) <= TUNING.first_few:
        return -math.inf
    apart = min(max(TUNING.first_apart, news_take(view)), TUNING.first_time / (len(silent) + 1))
    before = sum(robot < stream.robot for robot in silent) if stream.sent is None else len(silent) + 1
    return stream.began + before * apart
