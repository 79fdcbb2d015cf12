"""How much of an adaptive limit the channel bears: additive increase, multiplicative decrease.

It grows only while it is used, so it is always known to have been borne. A decrease goes to what came through while a
queue grew, then lower for the time that the queue needs to drain: who hears of it sees the delay vanish and, with it,
the reason for another decrease.
"""

import math

INITIAL = 0.25
"""Where an estimate starts, as a part of the ceiling."""
STEP = 0.025
"""Part of the ceiling that an estimate grows by in a second, and so much more for each second that is calm."""
PROBING = 0.5
"""Part of itself that it grows by at most, and until the first decrease, after silence, and up to what others bear."""
QUIET = 3.0
"""So long after a decrease it is calm [s]."""
LESS, LEAST_CUT, DEEPEST_CUT, AGAIN = 0.95, 0.9, 0.5, 0.7
"""A decrease: to so much of what came through; at least and at most to so much; to so much when the last one failed."""
DRAIN, LEFT = 0.5, 0.35
"""A queue is to drain in this time [s]; so much of the estimate is left to send, even if it takes longer."""
LONGEST_DRAIN = 2.0
"""A queue is given up to this long to drain [s]."""
AGAIN_WITHIN = 1.0
"""The last decrease has failed when there is cause for another one so soon after it settled [s]."""
SETTLE = 0.2
"""So long it takes until the others know of a decrease and have sent what they had decided on [s]."""


PATIENCE = 1.0
"""So long we wait for what a decrease of others comes to [s]."""


class Estimate:
    """One limit's, as a part of its ceiling, never below `floor`."""

    def __init__(self, now: float, floor: float) -> None:
        self.floor = floor
        self.part = max(floor, INITIAL)
        self.bounded = False
        """Whether anything ever spoke against more."""
        self._probing = True
        self._draining = 1.0
        self._cut_for = 0.0
        self._cut_at = now
        self._drained_at = now
        self._settled_at = now

    def told(self, now: float) -> float:
        """What the channel bears now: less than the estimate while a queue drains."""
        return max(self.floor, self.part * (self._draining if now < self._drained_at else 1.0))

    @property
    def settled_at(self) -> float:
        """What is seen of what was sent from then on [s] is not the effect of what was decreased for."""
        return self._settled_at

    @property
    def drained_at(self) -> float:
        """When the last queue has drained [s]."""
        return self._drained_at

    def grow(self, now: float, elapsed: float, most: float, others: float) -> None:
        """It was used and nothing stood in the way for `elapsed` [s]; it grows to `most` at most.

        It grows fast as long as all the `others` say that the channel bears more, unless a decrease says otherwise;
        where they say nothing, what counts is known to us alone, and it grows no faster for being calm.
        """
        calm = now - self._cut_at - QUIET
        step = fastest = PROBING * self.part
        if not self._probing and (calm < 0.0 or self.part >= others):
            step = min(STEP * (1.0 + max(0.0, calm if others > 0.0 else 0.0)), fastest)
        self.part = max(self.part, min(self.part + step * elapsed, most, 1.0))

    def follow(self, word: float, *, agrees: bool) -> None:
        """Another robot says what is in force: that is ours, too, if we agree with it, or if it is less."""
        self.part = max(self.floor, word if agrees else min(self.part, word))

    def heed(self, now: float, word: float, delay: float) -> None:
        """Others say that the channel bears less; here, too, a queue of `delay` [s] may be seen, which is to drain."""
        self.part = max(self.floor, min(self.part, word))
        self._drain(now, delay)

    def cut(self, now: float, used: float, share: float, delay: float) -> None:
        """A queue of `delay` [s] grew while `used` was sent, of which `share` came through."""
        failed = not self._probing and now < self._settled_at + AGAIN_WITHIN
        factor = min(max(LESS * share, DEEPEST_CUT), LEAST_CUT)
        self.part = max(self.floor, min(factor * used, (AGAIN if failed else factor) * self.part))
        self._drain(now, delay)

    def linger(self, now: float, delay: float) -> None:
        """A queue still stands: if we decreased for it, it drains longer, and once more if it has doubled since."""
        if not self._cut_at < now < min(self._drained_at + SETTLE, self._cut_at + LONGEST_DRAIN + delay / (1.0 - LEFT)):
            return
        if delay > 2.0 * self._cut_for:
            self._cut_for = math.inf
            self.part = max(self.floor, AGAIN * self.part)
        self._draining = min(self._draining, max(LEFT, 1.0 - delay / DRAIN))
        self._drained_at = max(self._drained_at, now + SETTLE)
        self._settled_at = max(self._settled_at, self._drained_at + SETTLE)

    def hold(self, now: float) -> None:
        """What tells of the channel is overdue: that may be a queue, so little is sent until something comes."""
        self._draining = LEFT
        self._drained_at = max(self._drained_at, now + SETTLE)

    def wait(self, now: float) -> None:
        """Others decreased for all: let that show."""
        self._settled_at = max(self._settled_at, now + PATIENCE)

    def fade(self) -> None:
        """Nothing was heard for too long; when something is, it may grow fast."""
        self.part = max(self.floor, AGAIN * self.part)
        self.bounded = self._probing = True

    def restore(self, part: float) -> None:
        """A decrease was for nothing."""
        self.part = max(self.part, min(part, 1.0))

    def _drain(self, now: float, delay: float) -> None:
        """Less is sent for as long as the queue needs to drain."""
        self.bounded, self._probing = True, False
        self._cut_at = now
        self._cut_for = delay
        self._draining = max(LEFT, 1.0 - delay / DRAIN)
        self._drained_at = now + min(max(DRAIN, delay / (1.0 - LEFT)), LONGEST_DRAIN)
        self._settled_at = max(self._settled_at, self._drained_at + SETTLE)
