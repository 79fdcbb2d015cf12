"""What changes on this robot besides its samples: who wants what here, its clock and links, specs and mode."""

from proxy.core.interface import events as ev
from proxy.core.interface.commands import Command, Notice
from proxy.core.model.limits import limits_of
from proxy.core.parts import Parts
from proxy.core.protocol.messages import tag
from proxy.core.reactions.retention import Retention


class TeamLimits:
    """Passes members and limits on to the parts that go by them."""

    def __init__(self, parts: Parts) -> None:
        self._parts = parts

    def set_members(self, now: float) -> None:
        """Somebody came, left, or turned out to have other limits."""
        aside = self._parts.mismatched.found
        self._parts.view.members.set_aside(aside)
        self.adopt(now)
        self._parts.coordination.set_members(now, self._parts.view.peers.keys() - aside)

    def adopt(self, now: float) -> None:
        """The limits are those of the specs in force, for as many robots as there are."""
        limits = limits_of(
            self._parts.view.specs, self._parts.settings.allowance, self._parts.view.members.speaking + 1
        )
        self._parts.coordination.set_limits(now, limits)
        self._parts.channel.adopt(now, limits)
        self._parts.budget.set_limits(self._parts.channel.limits, now)
        self._set_rate()

    def follow_channel(self, now: float) -> list[Command]:
        """Adaptive limits may have changed: put them in force, and set the pace of the mesh."""
        if (pace := self._parts.channel.apply()) is None:
            return []
        self._parts.budget.set_limits(self._parts.channel.limits, now)
        self._set_rate()
        return [pace]

    def leave_out_mismatched(self, now: float) -> list[Command]:
        """Robots may turn out to have other limits: no team waits for them, and the log says so."""
        before = self._parts.mismatched.worth_a_warning
        if self._parts.mismatched.look(now):
            self.set_members(now)
            for name in self._parts.mismatched.found & self._parts.view.peers.keys():
                self._parts.view.newcomers.doubt(now, self._parts.view.peers[name])
        new = self._parts.mismatched.worth_a_warning - before
        return [Notice("error", warning, {"reason": "limits"}) for warning in self._parts.mismatched.warnings(new)]

    def _set_rate(self) -> None:
        follows = bool(self._parts.channel.capacity.factors)
        self._parts.gossip.account.set_rate(self._parts.channel.allowance_factor, follows=follows)


class Changes:
    """Passes each change on to the parts that it concerns."""

    def __init__(self, parts: Parts, limits: TeamLimits, retention: Retention) -> None:
        self._parts = parts
        self._limits = limits
        self._retention = retention

    def interest(self, event: ev.InterestChanged) -> None:
        """The apps of this robot subscribe to other keys."""
        self._parts.view.subscribers.set_own(event.keys)
        self._parts.gossip.states.subscribed(event.now)

    def clock(self, event: ev.ClockChanged) -> list[Command]:
        """Our wall clock was set, or is known to be right, or is not any more."""
        self._parts.gossip.states.clock_set(event.now, event.wall_offset, event.error)
        self._parts.view.clocks.set(event.wall_offset, event.error)
        return self._parts.view.clocks.compare(event.now, self._parts.view.peers.values())

    def links(self, event: ev.LinksGauged) -> None:
        """Our own sockets say how long what we send waits."""
        for zid, wait in event.waits:
            self._parts.channel.capacity.evidence.link_gauged(event.now, tag(zid), wait)

    def specs(self, event: ev.SpecsChanged) -> list[Command]:
        """Another generation of specs is in force."""
        self._parts.view.streams.set_specs(event.specs)
        self._parts.counts.retain({each.name for each in event.specs.types})
        self._parts.gossip.states.review(event.now)
        self._parts.view.restart_losses()
        self._limits.adopt(event.now)
        return [*self._parts.gate.undecided.unsettle(), *self._retention.renew()]

    def mode(self, event: ev.ModeChanged) -> list[Command]:
        """An operator switched the mode."""
        self._parts.gossip.states.review(event.now)
        self._parts.view.restart_losses()
        released = self._parts.gate.set_mode(event.now, event.mode)
        return [*released, *self._retention.renew()]
