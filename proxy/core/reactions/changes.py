"""What changes on this robot besides its samples: who wants what here, its clock and links, specs and mode."""

from proxy.core.interface import events as ev
from proxy.core.interface.commands import Command
from proxy.core.parts import Parts
from proxy.core.protocol.messages import tag
from proxy.core.reactions.retention import Retention
from proxy.core.reactions.team_limits import TeamLimits


class Changes:
    """Passes each change on to the parts that it concerns."""

    def __init__(self, parts: Parts, limits: TeamLimits, retention: Retention) -> None:
        self._view = parts.view
        self._capacity = parts.channel.capacity
        self._gate = parts.gate
        self._states = parts.gossip.states
        self._limits = limits
        self._retention = retention

    def interest(self, event: ev.InterestChanged) -> list[Command]:
        """The apps of this robot subscribe to other keys."""
        self._view.subscribers.set_own(event.keys)
        self._states.review(event.now)
        return []

    def matching(self, event: ev.MatchingChanged) -> list[Command]:
        """Somebody on the mesh wants one of our keys, or nobody does any more."""
        self._view.streams.match(event.key, matching=event.matching)
        return []

    def clock(self, event: ev.ClockChanged) -> list[Command]:
        """Our wall clock was set, or is known to be right, or is not any more."""
        self._states.clock_set(event.now, event.wall_offset, event.error)
        self._view.clocks.set(event.wall_offset, event.error)
        return self._view.clocks.compare(event.now, self._view.peers.values())

    def links(self, event: ev.LinksGauged) -> list[Command]:
        """Our own sockets say how long what we send waits."""
        for zid, wait in event.waits:
            self._capacity.evidence.link_gauged(event.now, tag(zid), wait)
        return []

    def specs(self, event: ev.SpecsChanged) -> list[Command]:
        """Another generation of specs is in force."""
        self._view.streams.set_specs(event.specs)
        self._states.review(event.now)
        self._view.restart_losses()
        self._limits.adopt(event.now)
        return [*self._gate.undecided.unsettle(), *self._retention.renew()]

    def mode(self, event: ev.ModeChanged) -> list[Command]:
        """An operator switched the mode."""
        self._states.review(event.now)
        self._view.restart_losses()
        released = self._gate.set_mode(event.now, event.mode)
        return [*released, *self._retention.renew()]
