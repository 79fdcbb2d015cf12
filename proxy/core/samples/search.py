"""The decision that is being searched for: one at a time, so that each knows what the one before decided."""

import math
from dataclasses import dataclass

from planner import Plan
from proxy.core.coordination.budget import Budget
from proxy.core.interface.commands import Command, Decide
from proxy.core.model.settings import CoreSettings
from proxy.core.model.waiting import Waiting
from proxy.core.samples.away import Copy
from proxy.core.samples.decision_log import Searched
from proxy.core.samples.decisions import Decisions
from proxy.core.samples.inbox import Inbox
from proxy.core.samples.tuning import TUNING
from proxy.core.window.window import Window, WindowBuilder, WindowSize


@dataclass(frozen=True, slots=True)
class Pending:
    """The sample, or `copy`, being decided since `asked` [s]; messages may have been left out of its window."""

    ticket: int
    sample: Waiting
    window: Window
    iterations: int
    asked: float
    thinned: bool = False
    copy: Copy | None = None

    @property
    def decide(self) -> Decide:
        """The search that was asked for; its ticket is its seed."""
        return Decide(self.ticket, self.window.problem, self.ticket, self.iterations, self.asked)

    def searched(self, plan: Plan, *, cut: bool) -> Searched:
        """Return what is kept of this decision and its plan."""
        problem, _, full, candidates = self.window
        return Searched.of(plan, problem, candidates, full, self.iterations, cut=cut)


class Search:
    """Asks for a decision, and awaits its answer."""

    def __init__(self, settings: CoreSettings, budget: Budget, windows: WindowBuilder, decisions: Decisions) -> None:
        self.pending: Pending | None = None
        self._size = WindowSize(settings.deadline)
        self._iterations = settings.iterations
        self._budget = budget
        self._windows = windows
        self._decisions = decisions

    def busy(self) -> bool:
        """Whether an answer is awaited."""
        return self.pending is not None

    @property
    def answer_due(self) -> float:
        """Until when an answer may well come [s]; −∞ where none is awaited."""
        return -math.inf if self.pending is None else self.pending.asked + TUNING.answered_within

    def start(self, now: float, sample: Waiting, inbox: Inbox, ticket: int, copy: Copy | None = None) -> Command:
        """Have a sample decided, or the copy of one, while others wait in the inbox."""
        window = self._windows.build(now, sample, inbox, self._budget.problem_limits(now), self._size.messages)
        thinned = self._size.messages < window.full
        if thinned:
            self._decisions.thin(window.held, window.full)
        fewer = self._iterations // (1 + len(inbox) // TUNING.samples_per_halving)
        iterations = min(max(TUNING.fewest_iterations, fewer), self._iterations)
        self.pending = Pending(ticket, sample, window, iterations, now, thinned, copy)
        return self.pending.decide

    def answered(self, ticket: int, overhead: float) -> Pending | None:
        """Return the sample that waited for this answer; all but the search took `overhead` [s], ∞: too long."""
        pending = self.pending
        if pending is None or pending.ticket != ticket:
            return None
        self.pending = None
        self._size.note(pending.window.held, overhead, thinned=pending.thinned)
        return pending

    def deciding(self) -> list[Waiting]:
        """The sample that is being decided, if one is; a copy stays where it is kept."""
        return [] if self.pending is None or self.pending.copy is not None else [self.pending.sample]

    def cancel(self) -> list[Waiting]:
        """Ignore the answer when it comes; return the sample that was being decided."""
        deciding, self.pending = self.deciding(), None
        return deciding
