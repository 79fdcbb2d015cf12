"""When our state is announced to the others: what is new of it, or all."""

import math
from dataclasses import replace

from proxy.core.coordination.coordination import Coordination
from proxy.core.gossip.account import Account
from proxy.core.gossip.announcements import Announcements
from proxy.core.gossip.digest_budget import StateBudget
from proxy.core.gossip.own_state import as_announced, bare, differs, shortened, state_of, update_of
from proxy.core.gossip.tuning import TUNING
from proxy.core.interface.commands import Command, Notice, SendState
from proxy.core.model.mode import Mode
from proxy.core.protocol.messages import State
from proxy.core.protocol.split_report import SplitReport
from proxy.core.protocol.state_codec import pack_state
from proxy.core.view.view import SharedView


class StateAnnouncements:
    """The state that was announced last, and when the next one may follow it."""

    def __init__(
        self,
        now: float,
        view: SharedView,
        coordination: Coordination,
        *,
        account: Account,
        budget: StateBudget,
        announcements: Announcements,
    ) -> None:
        self._view = view
        self._coordination = coordination
        self._account = account
        self._budget = budget
        self._announcements = announcements
        self.state = State(view.settings.robot, view.settings.zid, "", "")
        """The one that was announced last; number 0: none."""
        self.left_out = 0
        """Streams, subscriptions and origins that did not fit into our state."""
        self._announced_at = self._reviewed_at = now - TUNING.states_apart
        self._review_at = now
        """When to look whether our state is news."""
        self._large_is_new = False
        """Whether a stream that others plan with is news."""
        self._subscriptions_are_new = False
        """Whether what our apps subscribe to is."""
        self._push_at, self._pushed = math.inf, -math.inf
        """When our state is sent to all robots that have come, and when it was sent so last [s]."""

    def review(self, at: float) -> None:
        """Our state may be news; look then [s]."""
        self._review_at = min(self._review_at, at)

    def subscribed(self, now: float) -> None:
        """Our apps subscribe to other keys: told at once, as nobody plans for streams that nobody wants."""
        self._subscriptions_are_new = True
        self.review(now)

    def sample_came(self, now: float, size: int, *, new: bool) -> None:
        """A stream of ours, which may be `new`, has a sample; look at once where others plan with what is new."""
        large = new and self._announcements.changes_plans(size)
        self._large_is_new |= large
        every = 0.0 if new else TUNING.review_every
        self.review(now if large else max(now + TUNING.gather, self._reviewed_at + every))

    def clock_set(self, now: float, offset: float, error: float) -> None:
        """Our wall clock is so much ahead of the monotonic one, and wrong by `error` at most [s]."""
        stepped = abs(offset - self.state.wall_offset) > TUNING.wall_clock_step
        if stepped or error != self._view.clocks.error:
            self.review(now)

    def met(self, now: float) -> None:
        """A robot came. In a large team it may ask only a few for their states, so we tell it our subscriptions."""
        if self._coordination.team.large and self.state.subscriptions and math.isinf(self._push_at):
            self._push_at = self._pushed = max(now + TUNING.gather, self._pushed + TUNING.pushes_apart)

    def asked(self, now: float) -> None:
        """Somebody asked for our state and got it."""
        self._account.sent_other(now, len(pack_state(self.state)), 1)

    def tell_parts(self, report: SplitReport, *, splits: bool) -> SendState:
        """Return our state with this report on parts, as an update of its number; the bid only if it is news."""
        before, self.state = self.state, replace(self.state, splits=splits, split=report)
        told = report
        if before.split is not None and before.split.version == report.version:
            told = replace(report, bid=None)
        return SendState(self.state, replace(bare(self.state), splits=splits, split=told))

    def due_at(self, now: float) -> float:
        """When a state may have to go out at the latest [s]."""
        return min(self._push_at, max(self._review_at, self._allowed_at(now)))

    def advance(self, now: float, mode: Mode) -> list[Command]:
        """Announce what is new, if it is time to; `mode` is ours."""
        commands = self._announce(now, mode) if now >= self._review_at and now >= self._allowed_at(now) else []
        if now >= self._push_at:
            self._push_at = math.inf
            self._account.sent_other(now, len(pack_state(self.state)), self._account.copies)
            commands.append(SendState(self.state, None))
        return commands

    def _allowed_at(self, now: float) -> float:
        """When a state may follow the last one [s]: once that is paid for; sooner what others plan with."""
        owed, ahead = self._budget.paid_in, self._large_is_new
        if self._subscriptions_are_new:
            ahead |= owed <= self._budget.takes(len(pack_state(self.state)), self._account.copies)
        ahead = ahead and not self._coordination.team.large
        return max(self._announced_at + TUNING.states_apart, now if ahead else now + owed)

    def _announce(self, now: float, mode: Mode) -> list[Command]:
        self._review_at, self._reviewed_at = math.inf, now
        self._large_is_new = self._subscriptions_are_new = False
        state, left_out = shortened(state_of(self._view, mode))
        if self.state.number and not differs(self.state, state):
            return []
        state = replace(as_announced(self.state, state), number=self.state.number + 1)
        state = replace(state, splits=self.state.splits, split=self.state.split)
        update = update_of(self.state, state)
        if update is not None and (until := self._announced_at + self._takes(update)) > now:
            self._review_at = until
            return []
        notices: list[Command] = []
        if left_out > self.left_out:
            text = f"{left_out} streams, subscriptions or origins are too many to tell the others"
            notices.append(Notice("warning", text))
        self.left_out, self.state, self._announced_at = left_out, state, now
        for each in state.streams:
            if (stream := self._view.streams.known(state.robot, each.key)) is not None:
                stream.sizes.announce(each.size)
        self._account.sent_other(now, len(pack_state(update or state)), self._account.copies)
        return [*notices, SendState(state, update)]

    def _takes(self, update: State) -> float:
        """Return how long news of our streams waits [s]: where a large team has equal parts nobody plans with it."""
        if not self._coordination.team.quiet:
            return 0.0
        return self._budget.takes(len(pack_state(update)), self._account.copies)
