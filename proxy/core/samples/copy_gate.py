"""The gate for copies: each is sent to the robot that it is for, or waits for as long as it is worth anything."""

from dataclasses import replace

from planner import Aggregation
from proxy.core.interface.commands import Command, SendCopy
from proxy.core.model.limits import use_of
from proxy.core.model.mode import Mode
from proxy.core.protocol.fixed import rounded
from proxy.core.samples.appraisal import Appraisal, Use
from proxy.core.samples.away import Copy
from proxy.core.samples.copies import Copies
from proxy.core.samples.decision_log import SEARCH, WAITS, Searched, Why
from proxy.core.samples.decisions import Decisions, Shortcut
from proxy.core.samples.fallback import StaticRule
from proxy.core.samples.inbox import Inbox
from proxy.core.samples.search import Search
from proxy.core.samples.tuning import TUNING
from proxy.core.view.stream import Stream


class CopyGate:
    """Decides copies as far as that needs no search, and takes its answers."""

    def __init__(
        self, appraisal: Appraisal, search: Search, decisions: Decisions, inbox: Inbox, copies: Copies
    ) -> None:
        self._appraisal = appraisal
        self._view, self._budget = appraisal.view, appraisal.budget
        self._search = search
        self._decisions = decisions
        self._log = decisions.log
        self._inbox = inbox
        self._copies = copies

    def foremost(self, now: float) -> Copy | None:
        """Return the copy of the highest priority, then the oldest, for who is back, if the inbox has none before."""
        first = (copy for away in self._copies if away.back for copy in away.oldest() if copy.ready_at <= now)
        copy = min(first, key=lambda c: (c.waiting.priority, *c.age_order), default=None)
        return None if copy is None or any(w.priority < copy.waiting.priority for w in self._inbox) else copy

    def take_up(self, now: float, copy: Copy, ticket: int) -> list[Command]:
        """Send a copy, or have it decided; while there is no room for it, it waits as long as it is worth anything."""
        stream = self._appraisal.stream_of(now, copy.waiting)
        if stream is None or stream.information_type.markovian:
            self._copies.give_up(copy, "dropped:no-spec")
            return []
        once = stream.information_type.aggregation is Aggregation.ONCE and not copy.delete
        if once and copy.to in stream.reached:
            self._copies.give_up(copy, "dropped:once")
            return []
        use, enforced = self._use(copy), self._appraisal.mode_of(stream) is Mode.ENFORCE
        if enforced and (lacking := self._appraisal.weigh_copy(now, use)):
            self._log.note(now, copy.waiting.key, copy.waiting, Why(WAITS, "", lacking), to=copy.to)
            return []
        if not enforced or copy.delete or self._appraisal.look_for_room(now, stream, len(self._inbox)):
            self._log.note(now, copy.waiting.key, copy.waiting, Why("forwarded", Shortcut.UNNEEDED), to=copy.to)
            return [self._send(now, stream, copy, use)]
        scale = rounded(stream.information_type.scale(copy.waiting.features))
        sample = replace(copy.waiting, scale=scale, to=copy.to)
        return [self._search.start(now, sample, self._inbox, ticket, copy)]

    def decided(self, now: float, copy: Copy, searched: Searched) -> list[Command]:
        """Take the answer for a copy: one that is not sent now may be sent later, when there is more room."""
        if not self._copies.waits(copy):
            return []
        use, plan = self._use(copy), searched.plan
        lacking = self._appraisal.weigh_copy(now, use) if plan.send else ()
        send = plan.send and not lacking
        reason = "forwarded" if send else WAITS
        why = Why(reason, SEARCH, lacking, searched=searched)
        self._log.note(now, copy.waiting.key, copy.waiting, why, to=copy.to)
        self._decisions.note(now, copy.waiting.key, reason, searched)
        return self._settle(now, copy, use, send=send)

    def by_rule(self, now: float, copy: Copy, rule: StaticRule) -> list[Command]:
        """There is no answer for a copy: it is sent if the rule leaves room for it."""
        if not self._copies.waits(copy):
            return []
        use = self._use(copy)
        lacking = self._appraisal.weigh_copy(now, rule.needed(copy.waiting, use))
        return self._settle(now, copy, use, send=not lacking)

    def _settle(self, now: float, copy: Copy, use: Use, *, send: bool) -> list[Command]:
        if send:
            return [self._send(now, self._appraisal.stream_of(now, copy.waiting), copy, use)]
        copy.postpone(now + TUNING.retry)
        return []

    def _send(self, now: float, stream: Stream | None, copy: Copy, use: Use) -> Command:
        if stream is not None and stream.information_type.aggregation is Aggregation.ONCE:
            stream.reach((copy.to,))
        messages = 1 + self._view.settings.relayed
        self._view.traffic.count(messages, messages * copy.waiting.size)
        if self._appraisal.mode_of(stream) is Mode.ENFORCE:
            self._budget.use(now, use)
        else:
            self._budget.use_at_most(now, use, 1.0)
        self._copies.hand(copy)
        return SendCopy(copy.waiting.sample, copy.to)

    def _use(self, copy: Copy) -> Use:
        """What a copy uses of the constraints: it goes to one robot, and when relayed to the router before."""
        return use_of(copy.waiting.size, 1 + self._view.settings.relayed, self._budget.limits)
