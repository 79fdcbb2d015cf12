"""How long a sample that must not be dropped waits for a link that is slower than the others.

Zenoh publishes on one link after the other, and a full one holds up all behind it. Two routers would wait for as long
as it takes, with everything of the robot behind that one link. Here the others wait no longer than `LONGEST`.
"""

import time
from collections.abc import Callable

from proxy import clock
from proxy.bridge.headroom import Headroom

LONGEST = 0.25
"""How long the other links wait for a full one [s]."""
REST = 5.0
"""How long nothing waits again for links that let it run out [s]."""
_LOOK = 0.002
"""Time between two looks at the links [s]."""


class Patience:
    """Waits for links, on the thread that may be held up, until `end`."""

    def __init__(self, headroom: Headroom, wait: Callable[[float], object] = time.sleep) -> None:
        self._headroom = headroom
        self._wait = wait
        self._lost_at = -REST
        self._ended = False
        self.lost = 0
        """How often it ran out."""

    def end(self) -> None:
        """Wait no more."""
        self._ended = True

    def runs_out(self) -> bool:
        """Wait for room on all links; whether some still have none while others do.

        Where no link has room the channel is full, and the first that has it again is not held up by the others.
        """
        until = clock.monotonic() + LONGEST
        while not self._ended:
            full, links = self._headroom.slow()
            if not full or links == 1:
                break
            if full < links and self._lost(clock.monotonic(), until):
                return True
            self._wait(_LOOK)
        return False

    def _lost(self, now: float, until: float) -> bool:
        if now - self._lost_at < REST:
            return True
        if now < until:
            return False
        self._lost_at = now
        self.lost += 1
        return True
