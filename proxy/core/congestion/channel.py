"""The limits in force: those of the specs, of which adaptive ones follow what the channel bears.

What the leader has in force holds for all, and only its estimate grows; the others object when they see a queue, which
decreases the limit for all, once. After that all who see the queue send less until it has drained: five robots on a
constant link reach 98.2 % of what a right limit reaches (broadcast, four seeds).
"""

import math
from collections.abc import Iterable
from typing import Any

from proxy.core.congestion.aimd import AdaptiveLimit, CapacityReports
from proxy.core.congestion.control import CongestionControl, Traffic
from proxy.core.congestion.evidence import Evidence
from proxy.core.congestion.tuning import TUNING
from proxy.core.interface.commands import SetPace
from proxy.core.model.limits import Limit, in_force, use_of
from proxy.core.protocol.messages import Digest, tag
from proxy.core.view.stream import Stream
from proxy.core.view.view import SharedView


class Capacity:
    """The adaptive limits among those of the specs, which are the ceilings."""

    def __init__(self, now: float, own: str) -> None:
        self.evidence = Evidence(now, own)
        self.factors: tuple[float, ...] = ()
        """Of every adaptive limit, the part of its ceiling that is in force."""
        self.due_at = math.inf
        """When it is time to look at the channel [s]."""
        self._limits: tuple[AdaptiveLimit, ...] = ()
        self._reports = CapacityReports(own)
        self._control = CongestionControl(now, self.evidence, self._reports)
        self._last_report: tuple[float, ...] = ()
        self._looked_at = now

    def set_limits(self, now: float, limits: Iterable[Limit]) -> None:
        """The constraints in force are now these; estimates of limits of the same name stay."""
        before = {limit.ceiling.name: limit.aimd for limit in self._limits}
        ceilings = enumerate(limit for limit in limits if limit.least < 1.0)
        self._limits = tuple(AdaptiveLimit(now, k, each, before.get(each.name)) for k, each in ceilings)
        self._control.set_limits(self._limits)
        self._take_effect()

    def digest_received(self, now: float, digest: Digest, paid_at: float) -> None:
        """A digest of another robot arrived; the allowance pays until `paid_at` [s] for what all told so far."""
        if self._limits:
            self.evidence.digest_received(now, digest, paid_at)
            if not digest.brief:
                self._reports.note(now, digest)

    def forget(self, peer: str) -> None:
        """A robot left: it is no evidence of anything."""
        self.evidence.forget(peer)
        self._reports.forget(peer)
        self._control.forget_drops()

    def staleness(self, now: float) -> float:
        """How long news of others wait on their way here [s]."""
        overdue = self.evidence.liveness.staleness(now) if self._control.overdue else 0.0
        return max(overdue, self._control.queue_delay)

    def wakes_at(self, now: float) -> float:
        """When limits change by themselves [s], as a queue has drained."""
        return min((t for limit in self._limits if (t := limit.aimd.drained_at) > now), default=math.inf)

    def look(self, now: float, traffic: Traffic) -> None:
        """React to what is seen now, and put in force what all report together."""
        self._looked_at = now
        self._reports.set_leader(now, traffic.leader)
        self._control.look(now, traffic)
        for limit in self._limits:
            limit.combine(now, self._reports, traffic.receivers, self._control.queue_delay)
        self._take_effect()

    def probe_due(self, now: float) -> bool:
        """Whether it is time for a digest only for its delay to be seen: the channel is in use."""
        due_at = self.evidence.liveness.last_sent + TUNING.probe_interval
        return self._control.busy(now) and bool(self.evidence.paths) and now >= due_at

    def has_news(self, now: float) -> bool:
        """Whether the others should hear at once what we would report."""
        report, last, count = self.report(now), self._last_report, len(self._limits)
        if len(report) > len(last):
            return True
        changes = list(zip(report, last, strict=False))[:count]  # what is used is no news
        return any(new < TUNING.fell * old or new > TUNING.rose * old for new, old in changes)

    def report(self, now: float) -> tuple[float, ...]:
        """What a digest reports: of every adaptive limit, the part that the channel bears by our evidence.

        Who leads reports what it has in force, and what part of every limit all use.
        """
        if self._reports.leads:
            lasting = (limit.lasting for limit in self._limits)
            return (*lasting, *(min(used, 1.0) for used in self._control.used))
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
            "used": self._control.used[number],
            "delay": self._control.queue.delay if self._control.queue else None,
            "lost": self.evidence.delivery.excess_loss(now),
            "reason": self._control.reason,
        }

    def warnings(self) -> list[str]:
        """Name every limit of which the channel does not bear the floor: a long queue stands though it is in force."""
        delay = self._control.queue_delay
        if delay < TUNING.hopeless_delay:
            return []
        return [
            f'constraint "{limit.ceiling.name}": the channel does not carry its floor, what is sent waits for '
            f"{delay:.0f} s: set a lower one"
            for limit in self._limits
            if limit.lasting <= limit.ceiling.least
        ]

    def _take_effect(self) -> None:
        self.factors = tuple(limit.in_force for limit in self._limits)
        self.due_at = self._looked_at + TUNING.look_interval if self._limits else math.inf


class Channel:
    """The limits of the specs as ceilings, and what is in force of them."""

    def __init__(self, now: float, view: SharedView) -> None:
        self.capacity = Capacity(now, tag(view.settings.zid))
        self.limits: tuple[Limit, ...] = ()
        self.staleness = 0.0
        """How long news of others wait on a channel that is full [s]."""
        self._view = view
        self._ceilings: tuple[Limit, ...] = ()
        self._adaptive: tuple[Limit, ...] = ()
        self._factors: tuple[float, ...] | None = ()
        """Those of which the driver knows."""

    @property
    def due_at(self) -> float:
        """When to look at it, and to put in force what it bears [s]."""
        return -math.inf if self._factors != self.capacity.factors else self.capacity.due_at

    @property
    def allowance_factor(self) -> float:
        """How much of the allowance is left: as much as of the limits, so that it is the same part of them."""
        return min(self.capacity.factors, default=1.0)

    def adopt(self, now: float, limits: tuple[Limit, ...]) -> None:
        """The limits are now these; adaptive ones begin where those of the same name are."""
        self._ceilings, self._adaptive = limits, tuple(limit for limit in limits if limit.least < 1.0)
        self.capacity.set_limits(now, limits)
        if self._factors or self.capacity.factors:
            self._factors = None  # so that the driver is told
        self.limits = in_force(limits, self.capacity.factors)
        self.staleness = 0.0  # until the next look: without adaptive limits there is none

    def look(self, now: float, dropped: int) -> bool:
        """Look at the channel, `dropped` samples of ours so far, if it is time to; whether all should hear at once."""
        if now < self.capacity.due_at:
            return False
        self.capacity.evidence.sent(now, self._view.traffic.messages, self._view.traffic.bytes)
        self.capacity.look(now, self._traffic(now, dropped))
        self.staleness = self.capacity.staleness(now)
        return self.capacity.has_news(now)

    def apply(self) -> SetPace | None:
        """Put in force what the channel bears; return the pace for the mesh when other limits are in force."""
        if self.capacity.factors == self._factors:
            return None
        self._factors = self.capacity.factors
        self.limits = in_force(self._ceilings, self._factors)
        if not self._factors:
            return SetPace(math.inf)
        pairs = zip(self.limits, self._ceilings, strict=True)
        return SetPace(min(limit.measure.pace * limit.limit / ceiling.limit for limit, ceiling in pairs))

    def _traffic(self, now: float, dropped: int) -> Traffic:
        streams = self._view.contention.all(now)
        own = self._view.settings.robot
        receivers = {name for s in streams if s.robot == own for name in self._view.subscribers.of(s)}
        others = (stream for stream in self._view.streams if stream.robot != own)
        parts = [self._parts(stream) for stream in streams]
        windows = [limit.window / part for limit, part in zip(self._adaptive, self.capacity.factors, strict=True)]
        return Traffic(
            dropped=dropped + sum(stream.unsent for stream in others),
            receivers=receivers,
            longest=max((part * time for each in parts for part, time in zip(each, windows, strict=True)), default=0.0),
            each=tuple(sum(each[k] for each in parts) for k in range(len(windows))),
            one=tuple(max((each[k] for each in parts), default=0.0) for k in range(len(windows))),
            leader=self._leader(),
        )

    def _leader(self) -> str:
        """Whose report on the channel counts: of all that take part the robot with the least tag."""
        present = (name for name, peer in self._view.peers.items() if not peer.plain)
        return min((tag(self._view.settings.zid), *present))

    def _parts(self, stream: Stream) -> tuple[float, ...]:
        """What a sample takes of the ceilings of adaptive limits."""
        uses = use_of(stream.newest.size, self._view.subscribers.copies(stream), self._adaptive, own=False)
        return tuple(use / limit.limit for use, limit in zip(uses, self._adaptive, strict=True))
