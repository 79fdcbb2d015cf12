"""How much of an adaptive limit the channel bears: additive increase, multiplicative decrease (AIMD).

A decrease goes to what came through while a queue grew, then lower for as long as the queue needs to drain.
"""

import math
from collections.abc import Collection

from proxy.core.congestion.tuning import TUNING
from proxy.core.model.limits import Limit
from proxy.core.protocol.messages import Digest


class CapacityReports:
    """The last report of each robot, by tag: parts of the ceilings of all adaptive limits, and whose report counts.

    That of a leader; where nobody else leads the least one, but no single one of several: it may be far away.
    """

    def __init__(self, own: str) -> None:
        self._own = own
        self._reports: dict[str, tuple[float, tuple[float, ...]]] = {}
        self.leader = ""
        self.follows = False
        """Whether another robot leads whose report we have."""

    @property
    def leads(self) -> bool:
        """Whether it is we who lead."""
        return self.leader == self._own

    def note(self, now: float, digest: Digest) -> None:
        """A robot reports something."""
        self._reports[digest.tag] = now, digest.capacity

    def forget(self, peer: str) -> None:
        """A robot left."""
        self._reports.pop(peer, None)

    def set_leader(self, now: float, leader: str) -> None:
        """This robot leads now, if anybody."""
        self.leader = leader
        self.follows = not self.leads and self._reports.get(leader, (-math.inf, ()))[0] > now - TUNING.lifetime

    def bound(self, now: float, k: int, limit: Limit, receivers: Collection[str]) -> float:
        """What the others leave of a limit: what our receivers report, and what the rest does."""
        return min(self._bound(now, k, limit, receivers, inside=inside) for inside in (True, False))

    def least(self, now: float, k: int) -> float:
        """The least that any other robot reports of a limit; nothing when none does."""
        return min((report[k] for _, report in self._fresh(now, k)), default=0.0)

    def used(self, count: int) -> tuple[float, ...] | None:
        """What part of each of so many limits all use, if a leader reports it."""
        report = self._reports[self.leader][1] if self.follows else ()
        return report[count : 2 * count] if len(report) >= 2 * count else None

    def _bound(self, now: float, k: int, limit: Limit, receivers: Collection[str], *, inside: bool) -> float:
        """What our receivers report, or the others: the least but one, where there are several."""
        reports = sorted(
            min(max(report[k], limit.least), 1.0)
            for peer, report in self._fresh(now, k)
            if (peer in receivers) is inside
        )
        return reports[min(1, len(reports) - 1)] if reports else 1.0

    def _fresh(self, now: float, k: int) -> list[tuple[str, tuple[float, ...]]]:
        """The reports on a limit that count: that of the leader alone, where we follow."""
        counting = {self.leader: (now, self._reports[self.leader][1])} if self.follows else self._reports
        return [(p, report) for p, (t, report) in counting.items() if t >= now - TUNING.lifetime and len(report) > k]


class Aimd:
    """The estimate of one limit, as a part of its ceiling, never below `floor`.

    It begins between them, as many times above the floor as below the ceiling: at a quarter of a ceiling of 50 times
    what the radio bears four robots with cameras filled a queue that nobody came through again.
    """

    def __init__(self, now: float, floor: float) -> None:
        self._floor = floor
        self.estimate = math.sqrt(floor)
        self.bounded = False
        """Whether anything ever spoke against more."""
        self.drained_at = now
        """When the last queue has drained [s]."""
        self.settled_at = now
        """What is sent from then on shows the effect of the last decrease [s]."""
        self._slow_start = True
        self._drain_factor = 1.0
        self._decreased_at = now
        self._explained = 0.0
        """A queue may be so long because of what was sent before our last decrease [s]. What others decrease for
        explains none: taken to explain any, cameras under a ceiling of 50 times what the radio bears reached 70 % of a
        right limit's utility, and reach 89."""

    def set_floor(self, floor: float) -> None:
        """The least part of the ceiling is another one under new specs."""
        self._floor = floor

    def allowed(self, now: float) -> float:
        """What the channel bears now: less than the estimate while a queue drains."""
        return max(self._floor, self.estimate * (self._drain_factor if now < self.drained_at else 1.0))

    def increase(self, now: float, elapsed: float, most: float, others: float) -> None:
        """The limit was used without congestion for `elapsed` [s]; the estimate grows to `most` at most.

        Fast up to what `others` report that the channel bears (0: nothing), unless it was decreased lately.
        """
        calm = now - self._decreased_at - TUNING.calm_after
        step = fastest = TUNING.slow_start * self.estimate
        if not self._slow_start and (calm < 0.0 or self.estimate >= others):
            step = min(TUNING.increase * (1.0 + max(0.0, calm if others > 0.0 else 0.0)), fastest)
        self.estimate = max(self.estimate, min(self.estimate + step * elapsed, most, 1.0))

    def follow(self, report: float, *, agrees: bool) -> None:
        """The leader reports what is in force: we take it over if we agree with the leader, or if it is less."""
        self._lower(report if agrees else min(self.estimate, report))

    def decrease_to(self, now: float, report: float, delay: float) -> None:
        """Others report that the channel bears less; a queue of `delay` [s] that we see is to drain."""
        self._lower(min(self.estimate, report))
        self._drain(now, delay)

    def decrease(self, now: float, used: float, share: float, delay: float) -> None:
        """A queue of `delay` [s] grew while `used` was sent, of which `share` came through.

        A long queue tells exactly how little that is: halved at most by each decrease, an estimate of 12 times what the
        radio bears was 4 times of it after 30 s, behind a queue of 13 s.
        """
        failed = not self._slow_start and now < self.settled_at + TUNING.failed_within
        deepest = TUNING.deepest_decrease * TUNING.certain_delay / max(delay, TUNING.certain_delay)
        factor = min(max(TUNING.below_delivered * share, deepest), TUNING.mildest_decrease)
        self._lower(min(factor * used, (TUNING.repeated_decrease if failed else factor) * self.estimate))
        self._drain(now, delay, share)

    def outgrown(self, delay: float) -> bool:
        """Whether a queue of `delay` [s] is twice as long as what was sent before the last decrease explains.

        What is sent since then need not have come through to know: it waits behind that queue.
        """
        return delay > 2.0 * self._explained

    def extend_drain(self, now: float, delay: float) -> None:
        """The queue that we decreased for still stands: it drains longer."""
        longest = TUNING.longest_drain + delay / (1.0 - TUNING.least_while_draining)
        if not self._decreased_at < now < min(self.drained_at + TUNING.settling, self._decreased_at + longest):
            return
        self._drain_factor = min(self._drain_factor, _drain_factor(delay))
        self.drained_at = max(self.drained_at, now + TUNING.settling)
        self._settle(self.drained_at + TUNING.settling)

    def hold_back(self, now: float) -> None:
        """Digests are overdue and may wait in a queue: little is sent until one comes."""
        self._drain_factor = TUNING.least_while_draining
        self.drained_at = max(self.drained_at, now + TUNING.settling)

    def await_others(self, now: float) -> None:
        """Others decreased the limit for all: wait for the effect."""
        self._settle(now + TUNING.effect_of_others)

    def decay(self) -> None:
        """Nothing was heard for too long. Slow start follows once something is heard."""
        self._lower(TUNING.repeated_decrease * self.estimate)
        self.bounded = self._slow_start = True

    def restore(self, estimate: float) -> None:
        """A decrease was for nothing."""
        self.estimate = max(self.estimate, min(estimate, 1.0))

    def _lower(self, estimate: float) -> None:
        self.estimate = max(self._floor, estimate)

    def _settle(self, at: float) -> None:
        self.settled_at = max(self.settled_at, at)

    def _drain(self, now: float, delay: float, share: float = 1.0) -> None:
        self.bounded, self._slow_start = True, False
        self._decreased_at, self._explained = now, delay / max(share, TUNING.least_share)
        held_back = self._drain_factor if now < self.drained_at else 1.0
        self._drain_factor = min(held_back, _drain_factor(delay))
        takes = max(TUNING.drain, delay / (1.0 - TUNING.least_while_draining))
        self.drained_at = now + min(takes, TUNING.longest_drain)
        self._settle(self.drained_at + TUNING.settling)


class AdaptiveLimit:
    """The `number`-th adaptive limit: our own estimate and what is in force of it, as parts of its `ceiling`."""

    def __init__(self, now: float, number: int, ceiling: Limit, aimd: Aimd | None = None) -> None:
        self.number = number
        self.ceiling = ceiling
        self.aimd = aimd or Aimd(now, ceiling.least)
        self.aimd.set_floor(ceiling.least)
        self.in_force = self.aimd.allowed(now)
        self.lasting = self.aimd.estimate
        """What is in force when queues have drained."""
        self.others = 1.0
        """What the others leave of it."""

    @property
    def objects(self) -> bool:
        """Whether our estimate is below what the others leave."""
        return self.aimd.estimate < TUNING.fell * self.others

    def combine(self, now: float, reports: CapacityReports, receivers: Collection[str], delay: float) -> None:
        """Put in force what all robots report together; we see a queue of `delay` [s]."""
        others = reports.bound(now, self.number, self.ceiling, receivers)
        if others < TUNING.fell * min(self.others, self.aimd.allowed(now)):
            self.aimd.await_others(now)
        if reports.follows:
            self.aimd.follow(others, agrees=not self.objects)
        elif reports.leads and others < TUNING.fell * self.aimd.estimate:
            self.aimd.decrease_to(now, others, delay)
        self.others = others
        self.lasting = min(self.aimd.estimate, others)
        self.in_force = min(self.aimd.allowed(now), others)


def _drain_factor(delay: float) -> float:
    """What part of the estimate lets a queue of `delay` [s] drain in time."""
    return max(TUNING.least_while_draining, 1.0 - delay / TUNING.drain)
