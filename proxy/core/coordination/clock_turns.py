"""Turns by the clock, for messages that are larger than an equal part, in a team that is too large to agree on turns.

There is room for a message of each robot in a *cycle*. Every robot has one window of it, and by the wall clock these
begin one after the other, in the order of tags. Where each robot sent once it had sent nothing for as many windows as
its message has parts, all sent in the same ones: thirty with equal messages had 67 % of the windows over the limit, by
up to 3.1 (unicast, 20 ms), and 28 with cameras 67 % by up to 2.8 (broadcast). Now it is none, with 80 % of one
decider's utility, and 8 % by up to 1.13, with 76.

A cycle depends on the number of robots and on the size of messages, which both are rounded up: else who misses some of
the others, or whose sizes vary, would have other turns each time.
"""

import math

from proxy.core.coordination.tuning import TUNING


class ClockTurns:
    """Our turns with the messages of one limit, which has this `window` [s]."""

    def __init__(self, window: float) -> None:
        self._window = window
        self._largest = 0
        """The largest part of the limit that a message took lately, as a number of steps."""
        self._needed = -math.inf
        """When a message was that large last [s]."""

    def began(self, wall: float, place: float, robots: int, part: float) -> float:
        """Return when our turn began for a message that takes this `part` of the limit [s]; ∞: it is not our turn.

        All by the `wall` clock. Our `place` among so many robots is between 0 and 1.
        """
        steps = _steps(part)
        if steps >= self._largest or wall > self._needed + TUNING.turn_cycles * self._cycle(robots):
            self._largest, self._needed = steps, wall
        cycle = self._cycle(robots)
        began = (math.floor(wall / cycle - place) + place) * cycle
        return began if wall < began + self._window else math.inf

    def _cycle(self, robots: int) -> float:
        """How long it takes until it is our turn again [s]."""
        return self._window * TUNING.turn_step ** (self._largest + _steps(robots))


def _steps(number: float) -> int:
    """Return how many steps lead from 1 to this number or just beyond."""
    return math.ceil(math.log(number, TUNING.turn_step))
