"""What this robot tells the others and asks them: states, questions, digests; all within the team's allowance."""

import zlib

from proxy.core.congestion.channel import Channel
from proxy.core.coordination.budget import Budget
from proxy.core.coordination.coordination import Coordination
from proxy.core.gossip.account import Account
from proxy.core.gossip.announcements import Announcements
from proxy.core.gossip.digest_budget import DigestBudget
from proxy.core.gossip.digest_composer import DigestComposer
from proxy.core.gossip.digest_scheduler import DigestScheduler
from proxy.core.gossip.state_announcements import StateAnnouncements
from proxy.core.gossip.state_requests import StateRequests
from proxy.core.gossip.stream_news import StreamNews
from proxy.core.gossip.tuning import TUNING
from proxy.core.interface.commands import AskState, Command
from proxy.core.model.mode import Mode
from proxy.core.view.view import SharedView


class Gossip:
    """One robot's part of the conversation. `limits` are those in force."""

    def __init__(
        self, now: float, view: SharedView, coordination: Coordination, limits: Budget, channel: Channel
    ) -> None:
        self._view = view
        self._coordination = coordination
        # Before parts are agreed on nobody sends: the first agreement may use what samples leave.
        turn = zlib.crc32(view.settings.zid.encode()) / 2**32
        self.budget = DigestBudget(now, turn, TUNING.first_parts_savings)
        self.account = Account(view, limits, self.budget)
        self.announcements = Announcements(view, coordination, limits, self.account, self.budget)
        self.states = StateAnnouncements(
            now,
            view,
            coordination,
            account=self.account,
            budget=self.budget.states,
            announcements=self.announcements,
        )
        self.requests = StateRequests(now)
        self.news = StreamNews()
        echoes = self.budget.echoes
        self.digests = DigestScheduler(
            view,
            coordination,
            channel,
            account=self.account,
            budget=self.budget,
            announcements=self.announcements,
            news=self.news,
            states=self.states,
            composer=DigestComposer(
                view, coordination, channel.capacity, news=self.news, echoes=echoes, states=self.states
            ),
        )

    def due_at(self, now: float) -> float:
        """When something is due at the latest, as far as that is known [s]."""
        return min(self.digests.due_at, self.requests.due_at, self.states.due_at(now))

    def met(self, now: float, name: str) -> None:
        """A robot with this tag is new: it is told everything, and asked for its state."""
        self.news.forget()
        self.states.met(now)
        self.requests.want(now, name)

    def state_asked(self, now: float) -> None:
        """Somebody asked for our state and got it: all the rest is told by the next digest."""
        self.states.asked(now)
        self.news.forget()
        self.announcements.greet()

    def advance(self, now: float, mode: Mode, *, urgent: bool, parts_changed: bool, relaxed: bool) -> list[Command]:
        """Tell and ask what is due now, in our `mode`; `urgent`: the channel is news; `relaxed`: nobody plans."""
        if relaxed and not (urgent or parts_changed) and self.digests.gather(now) and now < self.due_at(now):
            return []
        self._follow(now)
        commands = self.states.advance(now, mode)
        apart = self.budget.states.question_takes() if self._coordination.team.large else TUNING.questions_apart
        if (name := self.requests.take(now, apart)) is not None:
            self.account.sent_other(now, TUNING.question, 1)
            commands.append(AskState(self._view.peers[name].name, name))
        return [*commands, *self.digests.advance(now, urgent=urgent, parts_changed=parts_changed, relaxed=relaxed)]

    def _follow(self, now: float) -> None:
        """Take in what the allowance brought, by how the team shares the limits now."""
        if not self._view.peers:
            self.budget.advance(now)
            return
        team, begins = self._coordination.team, self._coordination.begins(now)
        self.budget.follow(now, splits=team.splits, quiet=team.quiet, begins=begins, window=self.account.window)
