"""Who asks: robots whose next message nobody can foresee, where the answer is quick and asking affordable.

Elsewhere who leads the shares lends ahead of time what a message is expected to take.
"""

from proxy.core.limits import LEAST_ALLOWANCE, LEAST_DIGEST, Limit
from proxy.core.peer import Peer
from proxy.core.stream import Stream
from proxy.core.view import SharedView

PATIENCE = 0.25
"""A sample waits so long at most for what is lent to us from then on [s]."""
ANSWERED = 0.06
"""Who asks hears the answer so much later at most, besides the latency there and back [s]."""
HELD = 0.9
HOLD = 1.0
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


def serves(view: SharedView, stream: Stream, other: Peer, limits: tuple[Limit, ...]) -> bool:
    """Whether what is lent for a sample that is generated already is of use: it waits, or the next one is near."""
    return stream.schedule.period <= NEAR * _delay(other) or asks(view, stream, other, limits)


def held_until(stream: Stream, t_gen: float, other: Peer) -> float:
    """Until when a sample waits for who leads to lend what it takes."""
    answer = t_gen + 3.0 * other.offset.latency + ANSWERED
    if not stream.information_type.markovian:
        return answer
    return max(answer, t_gen + min(HOLD, HELD * stream.schedule.period))


def _delay(other: Peer) -> float:
    """When who asks has heard the answer [s]."""
    return 2.0 * other.offset.latency + ANSWERED
