"""One adaptive limit: our own estimate of it, what the others leave of it, and what is in force."""

from collections.abc import Collection

from proxy.core.congestion.aimd import Aimd
from proxy.core.congestion.capacity_reports import CapacityReports
from proxy.core.congestion.tuning import TUNING
from proxy.core.model.limits import Limit


class AdaptiveLimit:
    """The `number`-th adaptive limit. All values are parts of its `ceiling`."""

    def __init__(self, now: float, number: int, ceiling: Limit, aimd: Aimd | None = None) -> None:
        self.number = number
        self.ceiling = ceiling
        self.aimd = aimd or Aimd(now, ceiling.least)
        self.aimd.set_floor(ceiling.least)
        self.in_force = self.aimd.allowed(now)
        self.lasting = self.aimd.estimate
        """What is in force when queues have drained."""
        self.drained = self.in_force
        """What is in force for the robot that begins anew first."""
        self.others = 1.0
        """What the others leave of it."""
        self._begins = now
        self._until_then = 1.0
        """When our turn to begin anew comes, as a queue was there [s], and how much we send until then."""

    @property
    def objects(self) -> bool:
        """Whether our estimate is below what the others leave."""
        return self.aimd.estimate < TUNING.fell * self.others

    def combine(
        self, now: float, reports: CapacityReports, draining: float, receivers: Collection[str], delay: float
    ) -> None:
        """Put in force what all robots report together; we see a queue of `delay` [s].

        How much is left while a queue drains is reported as `draining`.
        """
        others = reports.bound(now, self.number, self.ceiling, receivers)
        if others < TUNING.fell * self.others and others < self.aimd.allowed(now):
            self.aimd.await_others(now)
        if reports.follows:
            self.aimd.follow(others, agrees=not self.objects)
        elif reports.leads and others < TUNING.fell * self.aimd.estimate:
            self.aimd.decrease_to(now, others, delay)
        self.others = others
        self.lasting = min(self.aimd.estimate, others)
        self.drained = min(self.aimd.allowed(now), others, draining)

    def take_turn(self, now: float, place: int, robots: int) -> None:
        """When a queue has drained robots begin anew one after the other, within a window, each in its place."""
        if self.drained < TUNING.fell * self.lasting:
            self._begins = now + min(self.ceiling.window, TUNING.longest_turn) * place / robots
            self._until_then = self.drained
        self.in_force = min(self.drained, self._until_then) if now < self._begins else self.drained
