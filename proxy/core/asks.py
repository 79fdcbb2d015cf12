"""Who asks: robots whose next message nobody can foresee, where the answer is quick and asking affordable.

Elsewhere who leads the shares lends ahead of time what a message is expected to take.
"""

import math

from proxy.core.limits import LEAST_ALLOWANCE, LEAST_DIGEST, Limit
from proxy.core.peer import Peer
from proxy.core.stream import Stream
from proxy.core.view import SharedView

PATIENCE = 0.25
"""A sample waits so long at most for what is lent to us from then on [s]."""
ANSWERED = 0.06
"""Who asks hears the answer so much later at most, besides the latency there and back [s]."""
HELD = 0.3
"""A sample that a newer one would supersede waits so long at most, should room for it become free [s]..."""
HELD_PART = 0.9
"""... and not for more than this part of its stream's period."""
LEAD = 0.02
"""A robot hears what we let it send so much before it decides on it, besides the latency [s]."""
NEAR = 2.0
"""A stream whose period is so many of these times can use for its next sample what is lent for the last one."""
SPREADS = 2.0
"""A message may be so many standard deviations of its generation time off."""
SPARE = 4.0
"""So many digests could be paid for in the time in which one is to be sent: the others go to who leads, and to news."""


def asks(view: SharedView, stream: Stream, other: Peer, limits: tuple[Limit, ...]) -> bool:
    """Whether the robot of a stream asks for what a message takes when it has generated it.

    `other` is who leads, or where we do, that robot.
    """
    delay = _delay(other)
    if delay > PATIENCE:
        return False
    schedule = stream.schedule
    robots = len(view.peers) + 1
    rates = [view.settings.allowance * c.measure.limit / c.window / robots for c in limits if c.measure.unit == "B"]
    rate = max(LEAST_ALLOWANCE, min(rates, default=0.0))
    unforeseen = schedule.kind == "poisson" or SPREADS * schedule.jitter > delay
    return unforeseen and schedule.period * rate > SPARE * LEAST_DIGEST


def waits_until(stream: Stream, t_gen: float, other: Peer) -> float:
    """Until when a sample generated at `t_gen` waits for what is lent to it [s]; nothing waits for a slow answer."""
    if not other.offset.known or _delay(other) > PATIENCE:
        return -math.inf
    longest = min(HELD, HELD_PART * stream.schedule.period) if stream.information_type.markovian else 0.0
    return t_gen + max(_delay(other) + other.offset.latency, longest)


def serves(now: float, stream: Stream, other: Peer) -> bool:
    """Whether what is lent for a sample that is generated already is of use: it waits, or the next one is near."""
    t_gen, delay = stream.newest.t_gen, _delay(other)
    near = stream.schedule.period <= NEAR * delay and now - t_gen <= PATIENCE
    return near or now + other.offset.latency + LEAD <= waits_until(stream, t_gen, other)


def _delay(other: Peer) -> float:
    """When who asks has heard the answer [s]."""
    return 2.0 * other.offset.latency + ANSWERED
