"""When digests go out.

A sample that takes much of a limit is announced as soon as it is sent, ahead of the allowance if need be, and on the
air again where many robots miss it: at a loss of 30 % 5 to 8 % of the windows of four robots were over the limit. All
other news wait until the allowance has room for them beside announcements.
"""

import math
from dataclasses import replace

from proxy.core.congestion.channel import Channel
from proxy.core.coordination.coordination import Coordination
from proxy.core.gossip.account import Account
from proxy.core.gossip.announcements import Announcements
from proxy.core.gossip.digest_budget import DigestBudget
from proxy.core.gossip.digest_composer import DigestComposer
from proxy.core.gossip.state_announcements import StateAnnouncements
from proxy.core.gossip.stream_news import StreamNews
from proxy.core.gossip.tuning import TUNING
from proxy.core.interface.commands import Command, SendDigest
from proxy.core.protocol.messages import Digest
from proxy.core.protocol.split_report import SplitReport
from proxy.core.protocol.state_codec import pack_state
from proxy.core.view.stream import Stream
from proxy.core.view.view import SharedView


class Retransmissions:
    """The newest announcement of ours, and when it is sent again."""

    def __init__(self) -> None:
        self.due_at = math.inf
        """When to send it again [s]."""
        self._left, self._after = 0, TUNING.retransmit_after
        self._digest: Digest | None = None

    def announced(self, digest: Digest, lost: float) -> None:
        """This announces a sample that was sent before; such a part of samples, and of digests, is lost."""
        missed, after = TUNING.missed, TUNING.retransmit_after
        times = math.ceil(math.log(missed) / math.log(lost) - 1e-9) if lost > missed else 1
        self._left = min(TUNING.retransmissions, max(0, times - TUNING.sent_so_far))
        self._digest, self._after = digest, after
        self.due_at = digest.sent + after if self._left else math.inf

    def take(self, now: float) -> Digest | None:
        """Return what is to be sent again now, if that is due."""
        if now < self.due_at or self._digest is None:
            return None
        self._left, self._after = self._left - 1, 2.0 * self._after
        self.due_at = now + self._after if self._left else math.inf
        return replace(self._digest, sent=now)


class DigestScheduler:
    """Sends digests and announcements, and repeats announcements, each when it is due."""

    def __init__(
        self,
        view: SharedView,
        coordination: Coordination,
        channel: Channel,
        *,
        account: Account,
        budget: DigestBudget,
        announcements: Announcements,
        composer: DigestComposer,
        news: StreamNews,
        states: StateAnnouncements,
    ) -> None:
        self._view = view
        self._coordination = coordination
        self._capacity = channel.capacity
        self._account = account
        self._budget = budget
        self._announcements = announcements
        self._composer = composer
        self._news = news
        self._states = states
        self._retransmissions = Retransmissions()
        self.due_at = -math.inf
        """When the next digest is due, as things are since the last event [s]."""
        self.urgent = False
        """Whether something changed enough to alter others' plans."""
        self._parts_changed, self._parts_since = False, math.inf
        """Whether what we tell of parts is news, and since when [s]."""
        self._apart = 0.0
        """Ordinary news are so far apart at least [s]."""
        self._sent_at = -math.inf
        """When the last digest went out, or news of parts did in a state [s]."""
        self._spoke = False
        """Whether any digest went out."""
        self._messages = 0
        """Messages that we had put on the air by then."""
        self._introduces: set[str] = set()
        """Keys of large streams that others do not know yet, or not their rhythms, or not that they ceased."""
        self._ceasing, self._ceasing_at = dict[str, float](), -math.inf
        """When those will have ceased that others take to go on, by key, and when that was looked for last [s]."""

    def valued(self, stream: Stream) -> None:
        """A sample of ours was valued: the others should hear of it soon if they want it and its value has changed."""
        copies = self._view.subscribers.copies(stream)
        if copies == 0:
            return
        self.urgent |= self._news.value_changed(stream)
        large = self._announcements.changes_plans(round(stream.sizes.mean), copies)
        if large and self._announcements.needed and self._news.introduces(stream):
            self._introduces.add(stream.key)

    @property
    def gathers_until(self) -> float:
        """Until when ordinary news may gather, where there is room for all [s]."""
        return self._budget.last_ordinary + TUNING.relaxed

    def gather(self, now: float) -> bool:
        """Let ordinary news gather for a moment, as there is room for all; return whether nothing else is due."""
        until = self.gathers_until
        if self.urgent or now >= until:
            return False
        self.due_at = min(self.due_at, until)
        return True

    def advance(self, now: float, *, urgent: bool, parts_changed: bool, relaxed: bool) -> list[Command]:
        """Send a digest if one is due; `urgent`: the channel is news; `relaxed`: nobody plans with what we tell."""
        self.urgent |= urgent
        self._apart = TUNING.relaxed if relaxed else 0.0
        self._parts_changed |= parts_changed
        commands: list[Command] = []
        digest_at = self._digest_at(now)
        if digest_at <= now and self._parts_changed and (report := self._statement(now)) is not None:
            commands += self._state(now, report)
        elif digest_at <= now:
            commands.append(self._send_news(now))
        elif self._retransmission_at(now) <= now and (again := self._retransmissions.take(now)) is not None:
            commands.append(self._send(now, again, announces=True))
        if commands:
            digest_at = self._digest_at(now)
        self.due_at = min(digest_at, self._retransmission_at(now))
        return commands

    def _digest_at(self, now: float) -> float:
        """When a digest goes out that is no repetition [s]."""
        if not self._view.peers:
            return now + TUNING.slowest_digest
        return max(self._sent_at + TUNING.digests_apart, self._wanted_at(now))

    def _retransmission_at(self, now: float) -> float:
        if self._retransmissions.due_at == math.inf:
            return math.inf
        ahead = self._budget.due_ahead(now, TUNING.retransmission_debt)
        return max(self._sent_at + TUNING.digests_apart, self._retransmissions.due_at, ahead)

    def _wanted_at(self, now: float) -> float:
        """When we tell something, by what there is to tell and what the allowance has room for [s]."""
        coordination = self._coordination
        self._news.look(self._view.streams.revision, self._view.streams.own())
        news = self._news.waiting or not coordination.settled or self._sent_something or self._capacity.probe_due(now)
        apart = self._apart if news else _slowest(self._view, now)
        due = self._budget.due(now, apart=apart, copies=self._account.digest_copies)
        undecided = coordination.team.undecided and self._view.settings.digests_on_air and not self._parts_changed
        if undecided and self._view.echoes.are_awaited(now):  # until these come nobody knows how long news take
            since = self._sent_at + TUNING.slowest_digest
            return max(since, self._budget.due_in_turn(now, since, TUNING.parts_debt, self._account.digest_copies))
        if coordination.forming(now) and not self._parts_changed:
            due = max(due, now + TUNING.slowest_digest)
            return min(due, self._announcements.tells_at(now)) if self._sent_much() else due
        self._parts_since = min(self._parts_since, now) if self._parts_changed else math.inf
        if self._parts_changed:  # though a sample waits to be announced, which may take longer
            due = min(due, max(self._parts_at(now), self._sent_at + TUNING.parts_apart))
        if now >= self._ceasing_at + TUNING.surely_over:  # not at each event, where a robot has hundreds of streams
            self._ceasing, self._ceasing_at = self._announcements.ceasing(self._news), now
        ceases_at = min(self._ceasing.values(), default=math.inf)
        if ceases_at <= now:
            self._introduces.update(key for key, at in self._ceasing.items() if at <= now)
        if self._sent_much() or self._announcements.silence_untold:
            due = min(due, self._announcements.tells_at(now))
        elif ceases_at < math.inf:
            due = min(due, max(ceases_at, self._announcements.tells_at(now)))
        return min(due, self._budget.due_soon(now)) if self.urgent and not coordination.team.splits else due

    def _parts_at(self, now: float) -> float:
        """When the allowance has room for news of parts [s]; who changes over to parts may go further ahead of it."""
        if not self._coordination.formation.established:
            return self._budget.due_ahead(now, TUNING.first_parts_debt)
        exchange = self._coordination.exchange
        at_once = exchange is not None and (exchange.passes_on or exchange.asks)
        since = -math.inf if at_once else self._parts_since
        return self._budget.due_in_turn(now, since, TUNING.parts_debt, self._account.digest_copies)

    @property
    def _sent_something(self) -> bool:
        return self._view.traffic.messages != self._messages

    def _sent_much(self) -> bool:
        """Whether we sent something since the last digest that changes what others plan, or will with a new stream."""
        if not self._announcements.needed:
            return False
        if self._introduces:
            return True
        return self._sent_something and self._announcements.changes_plans(self._view.traffic.largest)

    def _send_news(self, now: float) -> Command:
        """Send a digest, or only the announcement of what was sent where nothing else is due."""
        copies, only_parts = self._account.digest_copies, self._only_parts(now)
        sent_much = self._sent_much()
        if sent_much and not self._more_is_due(now, copies):
            digest = self._announcement(now)
            self._capacity.evidence.digest_sent(now, self._view.traffic.messages)
            self._announced(digest)
        else:
            digest = self._composer.digest(now, copies, only_parts=only_parts)
            self._capacity.reported(digest)
            self._coordination.announced(now, digest.split)
            self._announcements.told(splits=digest.splits)
            self.urgent = self._parts_changed = False
            if sent_much and self._announcements.overheard:
                large = {stream.id for stream in self._view.streams.own() if self._announcements.is_large(stream)}
                streams = tuple(each for each in digest.streams if each.id in large)
                self._announced(self._composer.announcement(now, streams))
        self._messages = self._view.traffic.messages
        self._introduces.clear()
        self._ceasing = {key: at for key, at in self._ceasing.items() if at > now}
        self._view.traffic.announced()
        return self._send(now, digest, announces=digest.brief or only_parts)

    def _statement(self, now: float) -> SplitReport | None:
        """Return what is to be told of parts in a state: in unicast, unless digests have to tell of the channel."""
        exchange = self._coordination.exchange
        if exchange is None or not exchange.has_statement:
            return None
        if self._view.settings.digests_on_air or self._capacity.factors or not self._states.state.number:
            return None
        return self._coordination.announcement(now)

    def _state(self, now: float, report: SplitReport) -> list[Command]:
        """Tell all of parts in a state, with a first digest beside it: a robot is heard by its digests."""
        self._parts_changed, self._sent_at = False, now
        self._coordination.announced(now, report)
        splits = self._coordination.team.votes_to_split
        command = self._states.tell_parts(report, splits=splits)
        self._announcements.told(splits=splits)
        self._account.sent_parts(now, len(pack_state(command.update or command.state)))
        if self._spoke:
            return [command]
        return [command, self._send(now, self._composer.announcement(now, ()), announces=True)]

    def _only_parts(self, now: float) -> bool:
        """Whether a digest tells of parts alone: nobody plans with others' streams where each has its own part."""
        if not self._coordination.team.splits or not self._parts_changed:
            return False
        return self._coordination.forming(now) or not self._all_is_due(now, self._account.digest_copies)

    def _all_is_due(self, now: float, copies: int) -> bool:
        """Whether it is time to tell all that is new, which announcements never replace."""
        apart = 0.0 if self._capacity.probe_due(now) else _slowest(self._view, now)
        return self._budget.due(now, apart=apart, copies=copies) <= now

    def _more_is_due(self, now: float, copies: int) -> bool:
        """Whether a whole digest has to go although an announcement would do for what was sent."""
        if (
            self.urgent
            or self._parts_changed
            or self._announcements.silence_untold
            or self._news.unknown
            or self._all_is_due(now, copies)
        ):
            return True
        return self._view.echoes.are_awaited(now) and self._budget.echoes.affords(copies) > 0

    def _announcement(self, now: float) -> Digest:
        """Return what was sent, in as few bytes as that takes; what is small is booked by its rate (now 83 % told)."""
        own = list(self._view.streams.own())
        keys = {s.key for s in own if self._announcements.is_large(s)}
        return self._composer.announcement(now, self._news.take(now, own, keys, self._introduces))

    def _announced(self, digest: Digest) -> None:
        """This announcement goes out, or a digest that says as much: what is broadcast may have to be sent again."""
        if digest.streams and self._announcements.overheard:
            self._retransmissions.announced(digest, self._view.paths.mean_loss())

    def _send(self, now: float, digest: Digest, *, announces: bool) -> Command:
        """Send a digest; one that `announces` does not count as ordinary news."""
        self._sent_at, self._spoke = now, True
        self._view.sent_digest(now)
        self._account.sent_digest(now, digest, announces=announces)
        return SendDigest(digest)


def _slowest(view: SharedView, now: float) -> float:
    """How far digests are apart that tell no news [s]; on the air some are lost."""
    if len(view.streams) or view.settings.digests_on_air or view.echoes.are_awaited(now):
        return TUNING.slowest_digest
    return TUNING.nothing_sent
