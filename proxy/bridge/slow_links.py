"""How long a sample that must not be dropped waits for a link that is slower than the others.

Zenoh publishes on one link after the other, and a full one holds up all behind it. Two routers would wait for as long
as it takes, with everything of the robot behind that one link. Here the others wait no longer than `slow_link_wait`.

What may be dropped on one link may be on all: Zenoh gives a link some pieces to hold, and drops what comes before its
thread has had the time to write them. So from then on each sample waits until the links with room have the one before.
A link that then lets that time run out has dropped what it seemed to have room for: nothing waits for it again either.
"""

import time
from collections.abc import Callable, Collection

from proxy import clock
from proxy.bridge.send_buffers import SendBuffers
from proxy.bridge.tuning import TUNING


class SlowLinks:
    """Waits for links, on the thread that may be held up, until `stop_waiting`."""

    def __init__(self, buffers: SendBuffers, wait: Callable[[float], object] = time.sleep) -> None:
        self._buffers = buffers
        self._wait = wait
        self._lost_at = -TUNING.slow_link_rest
        self._ended = False
        self._due: dict[str, int] = {}
        """What links will have sent when they have the sample before [B]."""
        self._given_up: set[str] = set()
        """Links with room that did not take the sample before."""
        self.lost = 0
        """How often a link was waited for in vain."""

    @property
    def calm(self) -> bool:
        """Whether no link was waited for in vain lately: then nothing that links have room for has to wait."""
        return clock.monotonic() - self._lost_at >= TUNING.slow_link_rest

    def stop_waiting(self) -> None:
        """Wait no more."""
        self._ended = True

    def stays_full(self) -> bool:
        """Wait for room on all links; whether some still have none while others do.

        Where no link has room the channel is full, and the first that has it again is not held up by the others.
        """
        until = clock.monotonic() + TUNING.slow_link_wait
        while not self._ended:
            full, links = self._buffers.slow()
            if not full or links == 1:
                break
            if full < links and self._lost(clock.monotonic(), until):
                return True
            self._wait(TUNING.full_link_check)
        return False

    def await_previous(self, size: int, takers: Collection[str]) -> None:
        """A sample is published next, to the sessions `takers` among others: wait until they have the one before."""
        if self.calm:
            self._due = {}
            self._given_up.clear()
            return
        until = clock.monotonic() + TUNING.slow_link_wait
        sent = self._buffers.sent()
        while (behind := self._behind(sent)) and not self._ended and clock.monotonic() < until:
            self._wait(TUNING.free_link_check)
            sent = self._buffers.sent()
        self._given_up |= behind
        self._due = {zid: done + size for zid, done in sent.items() if zid in takers and zid not in self._given_up}

    def _behind(self, sent: dict[str, int]) -> set[str]:
        return {zid for zid, due in self._due.items() if sent.get(zid, due) < due}

    def _lost(self, now: float, until: float) -> bool:
        if now - self._lost_at < TUNING.slow_link_rest:
            return True
        if now < until:
            return False
        self._lost_at = now
        self._due = {}
        self.lost += 1
        return True
