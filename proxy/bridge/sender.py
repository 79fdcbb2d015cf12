"""Writes samples on the mesh, and says what became of each."""

import threading
from collections.abc import Callable

from proxy import clock
from proxy.bridge.demand import Demand
from proxy.bridge.paced import Paced
from proxy.bridge.passed import EGRESS, Passed
from proxy.bridge.room import Room
from proxy.bridge.sample import Held
from proxy.bridge.tuning import TUNING
from proxy.bridge.writer import Writer
from proxy.core.interface.events import CopyHanded, CopyRefused, SampleHanded, SampleRefused

Answer = SampleHanded | SampleRefused | CopyHanded | CopyRefused


class Sender:
    """`post` gets an answer for each decided sample, and for each kept one; the others are counted in `passed`.

    Decided samples leave their place among the `covered` ones. What was sent counts for the `pace` of decided samples,
    which `lock` guards.
    """

    def __init__(
        self,
        writer: Writer,
        demand: Demand,
        passed: Passed,
        post: Callable[[Answer], None],
        *,
        covered: Room,
        pace: Paced,
        lock: threading.RLock,
    ) -> None:
        self._writer, self._demand, self._passed, self._post = writer, demand, passed, post
        self._covered, self._pace, self._lock = covered, pace, lock

    def on_air(self, held: Held) -> int:
        """What a sample puts on the air, copies counted [B]."""
        return held.size * (1 if held.to else self._demand.copies(held.key))

    def send_decided(self, number: int, held: Held, *, droppable: bool = False) -> float:
        """Send a decided sample; return when that was [s]."""
        self._leave(held)
        sent = self._writer.write(held, droppable=droppable)
        now = clock.monotonic()
        if sent:
            with self._lock:
                self._pace.sent(now, self.on_air(held))
        self._answer(now, number, held, sent=sent)
        return now

    def refuse(self, number: int, held: Held) -> None:
        """A decided sample cannot be sent any more."""
        self._leave(held)
        self._answer(clock.monotonic(), number, held, sent=False)

    def send_passing(self, reason: str, held: Held, *, droppable: bool = False) -> None:
        """Send a sample that passes, counted under `reason`; it pushes the next decided one back."""
        air = self.on_air(held)
        if not self._writer.write(held, droppable=droppable):
            self._passed.add(EGRESS, 0)
            return
        self._passed.add(reason, air)
        if not self._pace.unpaced:
            with self._lock:
                self._pace.push_back(clock.monotonic(), air, TUNING.push_back)

    def _leave(self, held: Held) -> None:
        """A decided sample waits no more. A copy has no place among them: the core bounds what is kept."""
        if not held.to:
            self._covered.leave(held.size)

    def _answer(self, now: float, number: int, held: Held, *, sent: bool) -> None:
        if held.to:
            self._post(CopyHanded(now, number, held.to) if sent else CopyRefused(now, number, held.to))
        else:
            self._post(SampleHanded(now, number) if sent else SampleRefused(now, number))
