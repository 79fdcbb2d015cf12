"""Congestion control: estimates of adaptive limits grow until silence, a queue, or loss beyond the usual."""

import math
from collections.abc import Collection
from dataclasses import dataclass, replace

from proxy.core.congestion.aimd import AdaptiveLimit, CapacityReports
from proxy.core.congestion.evidence import Evidence
from proxy.core.congestion.queue_delay import StandingQueue
from proxy.core.congestion.tuning import TUNING


@dataclass(frozen=True, slots=True)
class Traffic:
    """What the view knows of the use of the channel: samples `dropped` so far by anybody, who receives our samples.

    `longest`: what the longest sample takes as the limits are now [s]; `each`: the part of every ceiling that a sample
    of each stream takes together, `one`: the largest of these. The report of the `leader` counts for all.
    """

    dropped: int
    receivers: Collection[str]
    longest: float
    each: tuple[float, ...]
    one: tuple[float, ...]
    leader: str = ""


@dataclass(frozen=True, slots=True)
class _Trial:
    """These `estimates` were decreased because so much was `lost`; at `until` [s] it shows if that helps."""

    until: float
    lost: float
    estimates: tuple[float, ...]


class CongestionControl:
    """Reacts to what is seen of the channel. `reason` says how, in words for people, `used` what part of limits is."""

    def __init__(self, now: float, evidence: Evidence, reports: CapacityReports) -> None:
        self.reason = "nobody is there"
        self.queue: StandingQueue | None = None
        self.overdue = False
        """Whether a digest should have come by now, and waits somewhere."""
        self.used: tuple[float, ...] = ()
        self._evidence = evidence
        self._reports = reports
        self._limits: tuple[AdaptiveLimit, ...] = ()
        self._trial: _Trial | None = None
        self._free_at = now
        """When growth began or was last granted [s]."""
        self._decayed_at = now
        self._most_dropped = 0
        self._dropping_until = now
        self._used_at = -math.inf

    @property
    def queue_delay(self) -> float:
        """How long the queue is that stands [s]."""
        return self.queue.delay if self.queue else 0.0

    def set_limits(self, limits: tuple[AdaptiveLimit, ...]) -> None:
        """These are the adaptive limits now."""
        self._limits = limits
        self._trial = None
        self.used = (0.0,) * len(limits)

    def busy(self, now: float) -> bool:
        """Whether much of any limit in force is used, or samples were dropped just now."""
        return self._in_use or now < self._dropping_until

    def forget_drops(self) -> None:
        """A robot left: its dropped samples count no more."""
        self._most_dropped = 0

    def look(self, now: float, traffic: Traffic) -> None:
        """Increase or decrease the estimates by what is seen now."""
        # A sample that still waits for its decision looks like a dropped one for a moment.
        if traffic.dropped > self._most_dropped:
            self._dropping_until = now + max(TUNING.dropping, self._evidence.liveness.interval(now))
            self._most_dropped = traffic.dropped
        ceilings = [limit.ceiling for limit in self._limits]
        self.used = self._reports.used(len(ceilings)) or self._evidence.load.parts(now, ceilings)
        if self._in_use:
            self._used_at = now
        self.reason = self._react(now, traffic)
        if self.reason not in ("free", "settling"):
            self._free_at = now

    @property
    def _in_use(self) -> bool:
        pairs = zip(self.used, self._limits, strict=True)
        return any(used > TUNING.half_used * limit.in_force for used, limit in pairs)

    def _react(self, now: float, traffic: Traffic) -> str:
        bearable = TUNING.bearable_delay + TUNING.bearable_samples * min(traffic.longest, TUNING.longest_sample)
        self.queue, self.overdue = None, False
        if not self._evidence.paths:
            return "nobody is there"
        self.queue = self._standing(now, traffic.receivers, -math.inf, bearable)
        if silence := self._react_to_silence(now, bearable):
            return silence
        if congestion := self._react_to_congestion(now, traffic.receivers, bearable):
            return congestion
        return self._follow(now) if self._reports.follows else self._increase(now, traffic)

    def _react_to_silence(self, now: float, bearable: float) -> str:
        """Send less while nothing comes through, or while what is overdue may wait in a queue."""
        liveness = self._evidence.liveness
        if liveness.silent(now):
            if now >= self._decayed_at + TUNING.decay_interval:
                self._decayed_at = now
                for limit in self._limits:
                    limit.aimd.decay()
            return "silence"
        recently_used = now < self._used_at + TUNING.recently_used
        self.overdue = recently_used and liveness.overdue(now, bearable, len(self._evidence.paths))
        if not self.overdue:
            return ""
        for limit in self._limits:
            limit.aimd.hold_back(now)
        # A queue that is seen decreases the limit besides: what is left may be just what the channel bears.
        return "overdue" if self.queue_delay <= bearable else ""

    def _react_to_congestion(self, now: float, receivers: Collection[str], bearable: float) -> str:
        settled = max(limit.aimd.settled_at for limit in self._limits)
        new = cause = self._standing(now, receivers, settled, bearable)
        if all(limit.aimd.outgrown(self.queue_delay) for limit in self._limits):
            cause = self.queue
        if cause is not None and cause.delay > bearable:
            self._trial = None
            self._decrease(now, cause)
            return "delay"
        if self.queue is not None and (left := self.queue.left(now)) > bearable:
            for limit in self._limits:
                limit.aimd.extend_drain(now, left)
            return "draining"
        if self._tries_less(now):
            return "loss"
        if self.queue is None or new is None:
            return "settling"
        return "some delay" if self.queue_delay > bearable / 2.0 else ""

    def _standing(self, now: float, receivers: Collection[str], since: float, bearable: float) -> StandingQueue | None:
        """The longest queue that stands since then, for longer than what a limit lets be sent at once."""
        longest = max(limit.ceiling.window for limit in self._limits)
        span = min(max(TUNING.standing, longest), TUNING.longest_standing)
        return self._evidence.queue(now, receivers, since, bearable, span)

    def _decrease(self, now: float, queue: StandingQueue) -> None:
        for used, limit in zip(self.used, self._limits, strict=True):
            # Much less used than a limit means that others than us fill the channel.
            # So soon after another decrease what is used says little.
            lately = now < limit.aimd.settled_at + 2.0 * TUNING.rate_span
            lasting = limit.lasting
            borne = lasting if lately else min(max(used / TUNING.mostly_used, 0.5 * lasting), lasting)
            limit.aimd.decrease(now, borne, queue.share, queue.delay)

    def _tries_less(self, now: float) -> bool:
        """Whether a decrease is on trial because of loss; begin one, and end it with what it shows."""
        delivery, trial = self._evidence.delivery, self._trial
        lost = delivery.excess_loss(now)
        if trial is None:
            settled = all(now >= limit.aimd.settled_at + TUNING.ratio_span for limit in self._limits)
            if lost > TUNING.excess_loss and settled:
                estimates = tuple(limit.aimd.estimate for limit in self._limits)
                self._trial = _Trial(now + 2.0 * TUNING.ratio_span, lost, estimates)
                delivery.attribute_to_load(now)
                self._decrease(now, StandingQueue(0.0, 1.0 - lost))
        elif now < trial.until:
            self._trial = replace(trial, lost=max(lost, trial.lost))
        else:
            self._trial = None
            if lost > TUNING.helped * trial.lost:
                delivery.accept()
                for limit, estimate in zip(self._limits, trial.estimates, strict=True):
                    limit.aimd.restore(estimate)
        return self._trial is not None

    def _increase(self, now: float, traffic: Traffic) -> str:
        """Grow what is used, or what is too small for a sample of each stream: robots may wait for their turn then."""
        elapsed = min(now - self._free_at, max(1.0, self._evidence.liveness.interval(now)))
        self._free_at = now
        dropping, reason = now < self._dropping_until, "free"
        for k, limit in enumerate(self._limits):
            force, used = limit.in_force, self.used[k]
            full = used >= (TUNING.half_used if dropping else TUNING.used) * force
            if full or (dropping and max(used + traffic.one[k], traffic.each[k]) > force):
                # Nothing when only we see what is lost by load; and who leads knows no better than it reports.
                others = 0.0 if self._evidence.delivery.congested(now) else self._reports.least(now, k)
                others = min(others, force) if self._reports.leads else others
                limit.aimd.increase(now, elapsed, TUNING.untested * force, others)
            else:
                reason = "not used"
        return reason

    def _follow(self, now: float) -> str:
        elapsed, self._free_at = now - self._free_at, now
        for limit in self._limits:
            limit.aimd.increase(now, elapsed, limit.others, limit.others)
        return "free"
