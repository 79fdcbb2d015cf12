"""The parts of one robot's core, built once and from the lowest to the highest."""

import math
from dataclasses import dataclass
from typing import Self

from proxy.core.congestion.channel import Channel
from proxy.core.coordination.budget import Budget
from proxy.core.coordination.coordination import Coordination
from proxy.core.gossip.gossip import Gossip
from proxy.core.model.settings import CoreSettings
from proxy.core.samples.counts import Counts
from proxy.core.samples.gate import Gate
from proxy.core.samples.kept import Kept
from proxy.core.view.members import UnknownSenders
from proxy.core.view.mismatched_limits import MismatchedLimits
from proxy.core.view.view import SharedView
from proxy.core.window.window import WindowBuilder
from utility_specs import Specs

LONGEST_SLEEP = 1.0
"""Time passes this often at least [s]."""


@dataclass(frozen=True, slots=True)
class Parts:
    """What reactions to events change."""

    settings: CoreSettings
    view: SharedView
    mismatched: MismatchedLimits
    unknown_senders: UnknownSenders
    coordination: Coordination
    budget: Budget
    channel: Channel
    counts: Counts
    kept: Kept
    gate: Gate
    gossip: Gossip

    @classmethod
    def build(cls, settings: CoreSettings, specs: Specs, now: float) -> Self:
        """Return the parts of a core that begins now."""
        view, counts, kept = SharedView(settings, specs), Counts(), Kept(settings.away)
        coordination, channel = Coordination(now, settings, view), Channel(now, view)
        budget = Budget(view, coordination)
        return cls(
            settings=settings,
            view=view,
            mismatched=MismatchedLimits(view.peers, view.streams),
            unknown_senders=UnknownSenders(),
            coordination=coordination,
            budget=budget,
            channel=channel,
            counts=counts,
            kept=kept,
            gate=Gate(view, budget, counts, kept.copies, WindowBuilder(view, now)),
            gossip=Gossip(now, view, coordination, budget, channel),
        )

    def due_at(self, now: float) -> float:
        """When something is to be done that no event brings about [s]."""
        told = max(self.gossip.due_at(now), self.gate.search.answer_due)
        taken_up = math.inf if self.gate.search.busy() else self.gate.wakes_at
        due = min(told, taken_up, self.coordination.due_at(now), now + LONGEST_SLEEP)
        return max(min(due, self.channel.capacity.wakes_at(now)), now)
