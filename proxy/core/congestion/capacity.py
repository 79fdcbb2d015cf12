"""Adaptive limits: how much of each the channel bears, by our own evidence and by what the others report of theirs.

Every robot watches how long digests wait in queues, here and there, and whether anything gets through; from that it
estimates what the channel bears, and reports it in its digests (`capacity_reports.py`). Where one robot leads, what it
has in force holds for all, so all keep to the same limit, and only its estimate grows. The others follow it up and
down, and object when they see a queue: that decreases the limit for all, once, as whoever hears of it waits for the
effect.

After a decrease the queue has to drain: until then less is in force. That passes, so it is reported beside what lasts.
All would begin anew at once when it has drained; so they do one after the other.
"""

import math
from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace
from typing import Any

from proxy.core.congestion.adaptive_limit import AdaptiveLimit
from proxy.core.congestion.aimd import Aimd
from proxy.core.congestion.capacity_reports import CapacityReports
from proxy.core.congestion.evidence import Evidence
from proxy.core.congestion.queue_delay import StandingQueue
from proxy.core.congestion.tuning import TUNING
from proxy.core.model.limits import Limit
from proxy.core.protocol.messages import Digest


@dataclass(frozen=True, slots=True)
class Traffic:
    """What the view knows of the use of the channel: samples `dropped` so far by anybody, who receives our samples.

    `longest` is the time that the longest sample takes on a channel that is as the limits are now [s], `each` the part
    of every adaptive limit's ceiling that one sample of each stream takes together, and `one` the largest of these.
    The report of the `leader` counts for all.
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


class Capacity:
    """The adaptive limits among those of the specs, which are the ceilings."""

    def __init__(self, now: float, own: str) -> None:
        self._own = own
        self.evidence = Evidence(now, own)
        self.factors: tuple[float, ...] = ()
        """Of every adaptive limit, the part of its ceiling that is in force."""
        self.due_at = math.inf
        """When it is time to look at the channel [s]."""
        self._limits: tuple[AdaptiveLimit, ...] = ()
        self._ceilings: tuple[Limit, ...] = ()
        self._used: tuple[float, ...] = ()
        self._reports = CapacityReports(own)
        self._last_report: tuple[float, ...] = ()
        self._queue: StandingQueue | None = None
        self._reason = "nobody is there"
        self._trial: _Trial | None = None
        self._looked_at = now
        self._free_at = now
        """When growth began or was last granted [s]."""
        self._decayed_at = now
        self._most_dropped = 0
        self._dropping_until = now
        self._used_at = -math.inf

    def set_limits(self, now: float, limits: Iterable[Limit]) -> None:
        """The constraints in force are now these; estimates of limits of the same name stay."""
        before = {limit.ceiling.name: limit.aimd for limit in self._limits}
        self._ceilings = tuple(limit for limit in limits if limit.least < 1.0)
        aimds = [before.get(each.name) or Aimd(now, each.least) for each in self._ceilings]
        for aimd, ceiling in zip(aimds, self._ceilings, strict=True):
            aimd.set_floor(ceiling.least)
        pairs = enumerate(zip(self._ceilings, aimds, strict=True))
        self._limits = tuple(AdaptiveLimit(now, k, ceiling, aimd) for k, (ceiling, aimd) in pairs)
        self._trial = None
        self._used = (0.0,) * len(self._limits)
        self._take_effect()

    def digest_received(self, now: float, digest: Digest) -> None:
        """A digest of another robot arrived."""
        if self._limits:
            self.evidence.digest_received(now, digest)
            if not digest.brief:
                self._reports.note(now, digest)

    def forget(self, peer: str) -> None:
        """A robot left: it is no evidence of anything."""
        self.evidence.forget(peer)
        self._reports.forget(peer)
        self._most_dropped = 0

    def staleness(self, now: float) -> float:
        """How long news of others wait on their way here [s]."""
        overdue = self.evidence.liveness.staleness(now) if self._reason == "overdue" else 0.0
        return max(overdue, self._queue_delay)

    def wakes_at(self, now: float) -> float:
        """When limits change by themselves [s], as a queue has drained."""
        return min((t for limit in self._limits if (t := limit.aimd.drained_at) > now), default=math.inf)

    def look(self, now: float, traffic: Traffic) -> None:
        """Grow or decrease the estimates by what is seen now."""
        self._looked_at = now
        self._reports.set_leader(now, traffic.leader)
        self._note_drops(now, traffic.dropped)
        self._used = self._reports.used(len(self._limits)) or self.evidence.load.parts(now, self._ceilings)
        if self._in_use:
            self._used_at = now
        self._reason = self._react(now, traffic)
        if self._reason not in ("free", "settling"):
            self._free_at = now
        self._combine(now, traffic.receivers)
        self._take_effect()

    def probe_due(self, now: float) -> bool:
        """Whether it is time for a digest only for its delay to be seen: the channel is in use."""
        in_use = self._in_use or now < self._dropping_until
        return in_use and bool(self.evidence.paths) and now >= self.evidence.liveness.last_sent + TUNING.probe_interval

    def has_news(self, now: float) -> bool:
        """Whether the others should hear at once what we would report."""
        report, last, count = self.report(now), self._last_report, len(self._limits)
        if len(report) > len(last):
            return True
        changes = [
            (new, old) for k, (new, old) in enumerate(zip(report, last, strict=False)) if not count <= k < 2 * count
        ]
        return any(new < TUNING.fell * old or new > TUNING.rose * old for new, old in changes)

    def report(self, now: float) -> tuple[float, ...]:
        """What a digest reports: of every adaptive limit, the part that the channel bears by our evidence.

        Who leads reports what it has in force, by the evidence of all, and of every limit the part that is used by all.
        Who follows and does not object reports that, as does who knows of nothing against more.
        """
        if self._reports.leads:
            drained, lasting = ([limit.drained for limit in self._limits], [limit.lasting for limit in self._limits])
            return (*lasting, *(min(used, 1.0) for used in self._used), *(drained if drained != lasting else ()))
        if self._reports.follows:
            return tuple(limit.aimd.estimate if limit.objects else 1.0 for limit in self._limits)
        return tuple(limit.aimd.allowed(now) if limit.aimd.bounded else 1.0 for limit in self._limits)

    def reported(self, digest: Digest) -> None:
        """This digest of ours goes out."""
        self._last_report = digest.capacity
        self.evidence.liveness.digest_sent(digest.sent)
        self.evidence.digest_sent(digest.sent, digest.messages)

    def described(self, now: float, number: int) -> dict[str, Any]:
        """An adaptive limit as plain JSON data: parts of its ceiling, and what it reacts to."""
        limit = self._limits[number]
        return {
            "in_force": limit.in_force,
            "estimate": limit.aimd.estimate,
            "told": limit.aimd.allowed(now),
            "floor": limit.ceiling.least,
            "ceiling": limit.ceiling.limit,
            "used": self._used[number],
            "delay": self._queue.delay if self._queue else None,
            "lost": self.evidence.delivery.excess_loss(now),
            "reason": self._reason,
        }

    def _take_effect(self) -> None:
        self.factors = tuple(limit.in_force for limit in self._limits)
        self.due_at = self._looked_at + TUNING.look_interval if self._limits else math.inf

    def _note_drops(self, now: float, dropped: int) -> None:
        """More than ever before: a sample that still waits for its decision looks like a dropped one for a moment."""
        if dropped > self._most_dropped:
            self._dropping_until = now + TUNING.dropping
            self._most_dropped = dropped

    def _react(self, now: float, traffic: Traffic) -> str:
        """Increase or decrease the estimates; return why, in words for people."""
        bearable = TUNING.bearable_delay + TUNING.bearable_samples * min(traffic.longest, TUNING.longest_sample)
        self._queue = None
        if not self.evidence.paths:
            return "nobody is there"
        if silence := self._react_to_silence(now, bearable):
            return silence
        self._queue = self.evidence.queue(now, self._ceilings, traffic.receivers, -math.inf, bearable)
        if congestion := self._react_to_congestion(now, traffic.receivers, bearable):
            return congestion
        return self._follow(now) if self._reports.follows else self._increase(now, traffic)

    def _react_to_silence(self, now: float, bearable: float) -> str:
        """Send less while nothing comes through, or while what is overdue may wait in a queue."""
        liveness = self.evidence.liveness
        if liveness.silent(now):
            if now >= self._decayed_at + TUNING.decay_interval:
                self._decayed_at = now
                for limit in self._limits:
                    limit.aimd.decay()
            return "silence"
        recently_used = now < self._used_at + TUNING.recently_used
        if recently_used and liveness.overdue(now, bearable, len(self.evidence.paths)):
            for limit in self._limits:
                limit.aimd.hold_back(now)
            return "overdue"
        return ""

    def _react_to_congestion(self, now: float, receivers: Collection[str], bearable: float) -> str:
        """Decrease for a queue or for loss."""
        settled = max(limit.aimd.settled_at for limit in self._limits)
        new = self.evidence.queue(now, self._ceilings, receivers, settled, bearable)
        if new is not None and new.delay > bearable:
            self._trial = None
            self._decrease(now, new)
            return "delay"
        if self._queue_delay > bearable:
            for limit in self._limits:
                limit.aimd.extend_drain(now, self._queue_delay)
            return "draining"
        if self._tries_less(now):
            return "loss"
        if self._queue is None or new is None:
            return "settling"
        return "some delay" if self._queue_delay > bearable / 2.0 else ""

    def _decrease(self, now: float, queue: StandingQueue) -> None:
        for used, limit in zip(self._used, self._limits, strict=True):
            # Much less used than a limit means that others than us fill the channel.
            # So soon after another decrease what is used says little.
            lately = now < limit.aimd.settled_at + 2.0 * TUNING.rate_span
            lasting = limit.lasting
            borne = lasting if lately else min(max(used / TUNING.mostly_used, 0.5 * lasting), lasting)
            limit.aimd.decrease(now, borne, queue.share, queue.delay)

    def _tries_less(self, now: float) -> bool:
        """Whether a decrease is on trial because of loss; begin one, and end it with what it shows."""
        delivery, trial = self.evidence.delivery, self._trial
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
        elapsed = min(now - self._free_at, max(1.0, self.evidence.liveness.interval(now)))
        self._free_at = now
        dropping, reason = now < self._dropping_until, "free"
        for k, limit in enumerate(self._limits):
            force, used = limit.in_force, self._used[k]
            full = used >= (TUNING.half_used if dropping else TUNING.used) * force
            if full or (dropping and max(used + traffic.one[k], traffic.each[k]) > force):
                # Nothing when only we see what is lost by load; and who leads knows no better than it reports.
                others = 0.0 if self.evidence.delivery.congested(now) else self._reports.least(now, k)
                others = min(others, force) if self._reports.leads else others
                limit.aimd.increase(now, elapsed, TUNING.untested * force, others)
            else:
                reason = "not used"
        return reason

    def _follow(self, now: float) -> str:
        """Come to what the leader has in force."""
        elapsed, self._free_at = now - self._free_at, now
        for limit in self._limits:
            limit.aimd.increase(now, elapsed, limit.others, limit.others)
        return "free"

    def _combine(self, now: float, receivers: Collection[str]) -> None:
        """Put in force what all report together."""
        names = sorted((self._own, *self.evidence.paths))
        for k, limit in enumerate(self._limits):
            draining = self._reports.draining(now, k, len(self._limits))
            limit.combine(now, self._reports, draining, receivers, self._queue_delay)
            limit.take_turn(now, names.index(self._own), len(names))

    @property
    def _queue_delay(self) -> float:
        return self._queue.delay if self._queue else 0.0

    @property
    def _in_use(self) -> bool:
        """Whether much of any limit in force is used."""
        pairs = zip(self._used, self._limits, strict=True)
        return any(used > TUNING.half_used * limit.in_force for used, limit in pairs)
