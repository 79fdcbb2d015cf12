"""Who takes part, which limits hold for all of them, and what of it the parts have to know."""

from proxy.core.interface.commands import Command, Notice
from proxy.core.model.limits import limits_of
from proxy.core.parts import Parts


class TeamLimits:
    """Passes members and limits on to the parts that go by them."""

    def __init__(self, parts: Parts) -> None:
        self._allowance = parts.settings.allowance
        self._view = parts.view
        self._mismatched = parts.mismatched
        self._coordination = parts.coordination
        self._budget = parts.budget
        self._channel = parts.channel
        self._account = parts.gossip.account

    def set_members(self, now: float) -> None:
        """Somebody came, left, or turned out to have other limits."""
        self.adopt(now)
        self._coordination.set_members(now, self._view.peers.keys() - self._mismatched.found)

    def adopt(self, now: float) -> None:
        """The limits are those of the specs in force, for as many robots as there are."""
        limits = limits_of(self._view.specs, self._allowance, len(self._view.peers) + 1)
        self._coordination.set_limits(now, limits)
        self._channel.adopt(now, limits)
        self._budget.set_limits(self._channel.limits)
        self._set_rate()

    def follow_channel(self) -> list[Command]:
        """Adaptive limits may have changed: put them in force, and set the pace of the mesh."""
        if (pace := self._channel.apply()) is None:
            return []
        self._budget.set_limits(self._channel.limits)
        self._set_rate()
        return [pace]

    def leave_out_mismatched(self, now: float) -> list[Command]:
        """Robots may turn out to have other limits: no team waits for them, and the log says so."""
        before = self._mismatched.found
        if not self._mismatched.look(now):
            return []
        self.set_members(now)
        new = self._mismatched.found - before
        return [Notice("error", warning) for warning in self._mismatched.warnings(new)]

    def _set_rate(self) -> None:
        follows = bool(self._channel.capacity.factors)
        self._account.set_rate(self._channel.allowance_factor, follows=follows)
