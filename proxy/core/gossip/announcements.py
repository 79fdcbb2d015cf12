"""Which sends of ours the others have to hear of at once, and what that takes of the allowance."""

from collections.abc import Iterable

from proxy.core.coordination.budget import Budget
from proxy.core.coordination.coordination import Coordination
from proxy.core.coordination.team import Asking
from proxy.core.gossip.account import Account
from proxy.core.gossip.digest_budget import DigestBudget
from proxy.core.gossip.stream_news import StreamNews
from proxy.core.gossip.tuning import TUNING
from proxy.core.model.limits import changes_plans, shortest_window, use_of
from proxy.core.model.settings import is_broadcast
from proxy.core.view.stream import Stream
from proxy.core.view.view import SharedView


class Announcements:
    """Tells what has to be announced. `limits` are those in force."""

    def __init__(
        self, view: SharedView, coordination: Coordination, limits: Budget, account: Account, budget: DigestBudget
    ) -> None:
        self._view = view
        self._coordination = coordination
        self._limits = limits
        self._account = account
        self._budget = budget
        self._told_split = False
        """Whether we told last that the team has to split."""

    @property
    def overheard(self) -> bool:
        """Whether others hear our samples anyway, as these are broadcast."""
        return is_broadcast(self._view.settings.transport)

    @property
    def needed(self) -> bool:
        """Whether others plan with what we send: not where each has its part, nor while all agree on parts."""
        coordination = self._coordination
        return coordination.team.must_announce and not coordination.binds and coordination.meanwhile.confined >= 1.0

    @property
    def silence_untold(self) -> bool:
        """Whether the others do not know yet that we announce no more, as each keeps to an equal part.

        Told with other news they went on for 9 s as if we sent nothing: 13 % of the windows of six robots were over.
        """
        team = self._coordination.team
        return team.even and team.votes_to_split and not (self._told_split or team.strict or team.large)

    def told(self, *, splits: bool) -> None:
        """We tell the others whether the team has to split."""
        self._told_split = splits

    def due_at(self, now: float) -> float:
        """When a sample that is sent now could be announced [s]."""
        waits = self._coordination.team.rivals and self.needed and not self.overheard
        return self._budget.due_ahead(now, TUNING.announcement_debt, announces=True) if waits else now

    def tells_at(self, now: float) -> float:
        """When what changes plans is announced: ahead of the allowance, little so where nearly all overhear it [s]."""
        if self.overheard and self._view.paths.mean_loss() < TUNING.overheard_loss:
            return self._budget.due_ahead(now, TUNING.overheard_debt)
        return self._budget.due_ahead(now, TUNING.announcement_debt, announces=True)

    def passes_at(self, now: float) -> float:
        """When it could be told that a slot is passed on [s]."""
        return self._budget.due_with_parts(now, TUNING.parts_debt)

    def changes_plans(self, size: int, copies: int = 1) -> bool:
        """Whether a message of so many bytes, in so many copies, changes what others plan."""
        return changes_plans(use_of(size, copies, self._limits.limits), self._limits.limits)

    def is_large(self, stream: Stream) -> bool:
        """Whether the samples of a stream change what others plan."""
        return self.changes_plans(0 if stream.sent is None else stream.sent.size, self._view.subscribers.copies(stream))

    def ceasing(self, news: StreamNews) -> dict[str, float]:
        """Return when those large streams of ours are over of which others heard last that they go on, by key [s]."""
        copies = self._view.subscribers.copies
        large = (s for s in self._view.streams.own() if self.changes_plans(round(s.sizes.mean), copies(s)))
        return news.ceasing(large) if self.needed else {}

    def share(self, sending: Iterable[Asking]) -> float:
        """Return what part of the allowance it takes to announce all that the limits let these streams send."""
        if self.overheard:
            return 0.0
        limits, rate = self._limits.limits, 0.0
        load = [0.0] * len(limits)
        for _, use, interval in sending:
            if changes_plans(use, limits):
                often = 1.0 / interval
                rate += often
                load = [before + often * each for before, each in zip(load, use, strict=True)]
        fits = [c.limit / c.window / each for c, each in zip(limits, load, strict=True) if c.shared and each > 0.0]
        # Of a large team little is known for long; but that it sends some messages in each window.
        most = max(min([1.0, *fits]) * rate, TUNING.fewest_sends / shortest_window(limits))
        return most * (TUNING.announcement + TUNING.overhead) * self._account.digest_copies / self._budget.rate
