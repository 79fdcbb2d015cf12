"""What this robot tells the others and asks them: states, questions, digests; all within the team's allowance."""

import math
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
from proxy.core.gossip.stream_news import StreamNews
from proxy.core.gossip.tuning import TUNING
from proxy.core.interface.commands import AskState, Command
from proxy.core.model.mode import Mode
from proxy.core.view.peer import Peer
from proxy.core.view.view import SharedView


class StateRequests:
    """The open questions for states, by tag: to who is new, or whose digests name one that we lack; one for each."""

    def __init__(self, now: float) -> None:
        self.due_at = math.inf
        """When the next question is due [s]."""
        self.asked = 0
        """How often we asked."""
        self._open: dict[str, tuple[float, float]] = {}
        """When to ask next [s], and how long to wait for the answer then [s]."""
        self._next = self._asked_at = now
        self._left = float(TUNING.questions_at_once)

    def want(self, now: float, tag: str) -> None:
        """We lack the state of a robot."""
        self._open.setdefault(tag, (now, TUNING.first_answer))
        self._plan()

    def done(self, tag: str) -> None:
        """We have the state of a robot, or the robot is gone."""
        self._open.pop(tag, None)
        self._plan()

    def compare(self, now: float, tag: str, peer: Peer) -> None:
        """Ask a robot for its state if its last digest names another one; an older one only if it has just come."""
        if not peer.announced:
            self.want(now, tag)
        elif peer.digest is not None and (
            peer.digest.state > peer.state.number
            or (peer.digest_received == now and 0 < peer.digest.state < peer.state.number)
        ):
            self.want(now + TUNING.update_delay, tag)
        else:
            self.done(tag)

    def take(self, now: float, apart: float = TUNING.questions_apart) -> str | None:
        """Return whom to ask now, who waits longest; None: nobody. In the long run questions are so far `apart` [s]."""
        if now < self.due_at:
            return None
        tag = min(self._open, key=lambda t: (self._open[t], t))
        _, wait = self._open[tag]
        self._open[tag] = now + wait, min(2.0 * wait, TUNING.longest_wait)
        self._left = min(TUNING.questions_at_once, self._left + (now - self._asked_at) / apart) - 1.0
        self._asked_at = now
        self._next = now + max(TUNING.questions_apart, -self._left * apart)
        self.asked += 1
        self._plan()
        return tag

    def _plan(self) -> None:
        first = min((when for when, _ in self._open.values()), default=math.inf)
        self.due_at = max(self._next, first) if self._open else math.inf


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
            now, view, coordination, account=self.account, budget=self.budget.states, announcements=self.announcements
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
        self.requests.want(now, name)

    def state_asked(self, now: float) -> None:
        """Somebody asked for our state and got it: all the rest is told by the next digest."""
        self.states.asked(now)
        self.news.forget()

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
        self.budget.follow(
            now, splits=team.splits, quiet=team.quiet, begins=begins, window=self.account.window, tight=team.tight
        )
