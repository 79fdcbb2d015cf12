"""The gate: takes the next sample, has it decided, and forwards or drops it with a reason."""

import math
from collections.abc import Sequence
from functools import partial

from planner import Plan
from proxy.core.coordination.budget import Budget, in_turn
from proxy.core.interface.commands import Command, Notice
from proxy.core.interface.events import DecisionReady
from proxy.core.market.standing import Standing
from proxy.core.model.limits import use_of
from proxy.core.model.mode import Mode
from proxy.core.model.waiting import Waiting
from proxy.core.samples.appraisal import Appraisal, Use
from proxy.core.samples.copies import Copies
from proxy.core.samples.copy_gate import CopyGate
from proxy.core.samples.counts import Counts
from proxy.core.samples.decision_log import BOOKED, RIVALS, RULE, SEARCH, WAITS, Why
from proxy.core.samples.decisions import Decisions, Shortcut
from proxy.core.samples.fallback import StaticRule
from proxy.core.samples.outcomes import Outcomes, Run
from proxy.core.samples.search import Pending, Search
from proxy.core.samples.tuning import TUNING
from proxy.core.samples.undecided import Undecided
from proxy.core.samples.waits import Waits
from proxy.core.view.stream import Stream
from proxy.core.view.view import SharedView
from proxy.core.window.window import WindowBuilder

CONSTRAINT = "dropped:constraint"
OWED, UNNEEDED = Why("forwarded", Shortcut.OWED), Why("forwarded", Shortcut.UNNEEDED)
CERTAIN = Why("forwarded", Shortcut.CERTAIN)


class Gate:
    """Decides samples one after the other: as far as it can at once, else by a search, or by the static rule."""

    def __init__(
        self, view: SharedView, budget: Budget, counts: Counts, copies: Copies, windows: WindowBuilder
    ) -> None:
        self.decisions = Decisions()
        self.appraisal = Appraisal(view, budget, windows.disputes)
        self.outcomes = Outcomes(self.appraisal, counts, self.decisions)
        self.search = Search(view.settings, budget, windows, self.decisions)
        self.undecided = Undecided(view.settings, self.search, self.outcomes)
        self.wakes_at = math.inf
        """When a sample that waits can be taken up [s]."""
        self._view = view
        self._budget = budget
        self._copies = copies
        self._inbox = self.undecided.inbox
        self._waits = Waits(self.appraisal, self._inbox)
        self._copy_gate = CopyGate(self.appraisal, self.search, self.decisions, self._inbox, copies)
        self._rule = StaticRule(view, budget)
        self._complaint = ""
        self._tickets = 0
        self._overtaken = -1
        """The ticket of the last search beside which a sample was sent."""

    @property
    def waits(self) -> bool:
        """Whether a sample waits, be it to be read again, a copy does, or an answer is awaited."""
        return self.undecided.wait or bool(self._copies) or self.search.busy()

    def undecided_of(self, key: str) -> list[tuple[Waiting, float | None]]:
        """Return the samples of a key that are undecided, each with when there may be room for it [s], if it waits."""
        return [(each, self._inbox.rests_until(each.sample)) for each in self.undecided if each.key == key]

    def put(self, now: float, waiting: Waiting) -> list[Command]:
        """Send a sample at once if it surely fits, else queue it; too many go at once if they fit, else one leaves."""
        if self.appraisal.all_fits and not self.waits and (forwarded := self._send_fitting(now, waiting)) is not None:
            return [forwarded, *self.undecided.pass_deletions()]
        if self.search.busy() and (stream := self.appraisal.stream_of(now, waiting)) is not None:
            self.appraisal.published(now, stream)
            if (forwarded := self._send_beside(now, stream, waiting)) is not None:
                return [forwarded, *self.undecided.pass_deletions()]
        room = self._inbox.full(waiting) and self._takes_all(now, waiting)
        sent = self._send_all(now) if room else []
        return [*sent, *self.undecided.put(now, waiting)]

    def _send_fitting(self, now: float, sample: Waiting) -> Command | None:
        """Send a sample before which nothing waits, if there is room for it and for all that may be sent; else None."""
        stream, appraisal, view = self.appraisal.stream_of(now, sample), self.appraisal, self._view
        if stream is None or appraisal.mode_of(stream) is not Mode.ENFORCE or now < view.newcomers.greeted_by(now):
            return None
        if not view.subscribers.gaining(stream):
            return None
        use = appraisal.use(stream, sample)
        if not appraisal.look_for_room(now, stream, 0) or self._budget.lacking(now, use):
            return None
        return self._send_unweighed(now, stream, sample, use, must=appraisal.owed(now, stream, sample))

    def _send_unweighed(self, now: float, stream: Stream, sample: Waiting, use: Use, *, must: bool) -> Command:
        """Send a sample that nothing speaks against: it `must` be sent, or there is room for all."""
        if must:
            self.decisions.count(Shortcut.OWED)
        elif self._budget.limits:
            self.decisions.count(Shortcut.UNNEEDED)
        return self.outcomes.send(now, stream, sample, use, OWED if must else UNNEEDED)

    def _send_beside(self, now: float, stream: Stream, sample: Waiting) -> Command | None:
        """Send a sample beside one that a search decides on, if nothing disputes it or waits, and it fits."""
        pending, appraisal, view = self.search.pending, self.appraisal, self._view
        if pending is None or self._copies or self._waits.for_room or self.undecided.holds(sample.key):
            return None
        if appraisal.mode_of(stream) is not Mode.ENFORCE or now < view.newcomers.greeted_by(now):
            return None
        use, disputes = appraisal.use(stream, sample), appraisal.disputes
        if not view.subscribers.gaining(stream) or self._budget.lacking(now, use):
            return None
        if disputes.standing(now, stream, sample) is not Standing.UNDISPUTED:
            return None
        self._overtaken = pending.ticket
        self.decisions.count(Shortcut.UNDISPUTED)
        why = Why("forwarded", Shortcut.UNDISPUTED, weighed=disputes.weighed(stream))
        return self.outcomes.send(now, stream, sample, use, why)

    def passed(self, runs: Sequence[tuple[int, Run]]) -> None:
        """Samples went as they came; each run with the place of its last one among all of them, in order."""
        before, samples = self.decisions.log.noted, sum(run.samples for _, run in runs)
        self._tickets += samples
        if self._budget.limits:
            self.decisions.count(Shortcut.UNNEEDED, samples)
        for place, run in runs:
            self.outcomes.passed(run, UNNEEDED, before + place + 1)

    def set_mode(self, now: float, mode: Mode) -> list[Command]:
        """Do this with decisions from now on; in `pass` everything that waits passes."""
        self.appraisal.set_mode(mode)
        if mode is not Mode.PASS:
            return []
        commands: list[Command] = []
        self.undecided.settle_all()
        for sample in self.undecided.take_all():
            self.decisions.log.note(now, sample.key, sample, Why("passed:mode"))
            commands += [self.outcomes.pass_on(sample.sample, "passed:mode"), *self.undecided.pass_deletions()]
            self._budget.use_at_most(now, use_of(sample.size, 1, self._budget.limits), 1.0)
        return commands

    def next(self, now: float) -> list[Command]:
        """Take up samples until one needs a search, or none is left."""
        if self.search.busy():
            return []
        self._tickets += 1
        self._waits.restart(now)
        self.wakes_at = math.inf
        commands = self._take_up_all(now) if self._inbox or self._copies else []
        if not self.search.busy():
            self.appraisal.weigh_ahead(now)
        self.wakes_at = min(self.wakes_at, self.appraisal.disputes.due_at)
        return commands

    def _take_up_all(self, now: float) -> list[Command]:
        commands, crowded = list[Command](), False
        for _ in range(TUNING.taken_up_at_once):
            if self.search.busy():
                break
            if not crowded and (copy := self._copy_gate.foremost(now)) is not None:
                commands += self._copy_gate.take_up(now, copy, self._tickets)
                crowded = not self.search.busy() and self._copies.waits(copy)
            elif (sample := self.undecided.take(partial(self._waits.postpone, now))) is not None:
                commands += [self._take_up(now, sample, searching=True), *self.undecided.pass_deletions()]
                self._waits.left()
            else:
                break
        else:
            self.wakes_at = now
        self.wakes_at = min(self.wakes_at, self._waits.wakes_at, self._inbox.wakes_at, self._copies.next_at(now))
        return commands

    def ready(self, event: DecisionReady) -> list[Command]:
        """The answer for the pending sample, if that is still awaited; deletions that came meanwhile follow it."""
        pending = self.search.answered(event.ticket, event.overhead)
        if pending is None:
            return []
        if event.plan is not None:
            self._complaint = ""
            commands = self._decided(event, pending, event.plan)
        else:
            commands = [*self._complain(event.error), *self._without_plan(event.now, pending, late=False)]
        return [*commands, *self.undecided.pass_deletions()]

    def overdue(self, now: float, ticket: int) -> list[Command]:
        """There is no answer in time for the pending sample: what fits is sent at once."""
        pending = self.search.answered(ticket, math.inf)
        if pending is None:
            return []
        self.decisions.count(Shortcut.LATE)
        return [*self._without_plan(now, pending, late=True), *self.undecided.pass_deletions()]

    def _takes_all(self, now: float, waiting: Waiting) -> bool:
        """Whether all that is undecided may be sent now by every constraint in force, and one more sample."""
        if self._waits.for_room:
            return False
        left = self._budget.free(now)
        for each in (waiting, *self.undecided):
            use = self.appraisal.use(self.appraisal.stream_of(now, each), each)
            if self._budget.by_turn(now, use):
                return False
            left = [room - amount for room, amount in zip(left, use, strict=True)]
            if min(left, default=0.0) < 0.0:
                return False
        return True

    def _send_all(self, now: float) -> list[Command]:
        """Send all that waits, what is being decided before it."""
        commands: list[Command] = []
        for sample in self.undecided.take_all():
            commands += [self._take_up(now, sample, searching=False), *self.undecided.pass_deletions()]
        return commands

    def _take_up(self, now: float, sample: Waiting, *, searching: bool) -> Command:
        """Decide a sample as far as that needs no search; `searching`: by a search where it does, else it is sent."""
        stream = self.appraisal.stream_of(now, sample)
        if stream is None:
            return self.outcomes.pass_on(sample.sample, "passed:no-spec")
        if self._view.subscribers.count(stream) == 0:
            return self.outcomes.pass_unwanted(now, sample)
        use = self.appraisal.use(stream, sample)
        if self._budget.limits and not self._view.subscribers.gaining(stream):
            return self.outcomes.refuse(now, stream, sample, Why("dropped:once"))
        must = self.appraisal.owed(now, stream, sample)
        if lacking := self._budget.lacking(now, use):
            if must:
                self.decisions.count(Shortcut.UNKEPT)
            return self.outcomes.refuse(now, stream, sample, Why(CONSTRAINT, Shortcut.UNKEPT if must else "", lacking))
        if must or not searching or self.appraisal.look_for_room(now, stream, len(self._inbox)):
            return self._send_unweighed(now, stream, sample, use, must=must)
        return self._weigh(now, stream, sample, use)

    def _weigh(self, now: float, stream: Stream, sample: Waiting, use: Use) -> Command:
        """Decide by what room costs, or where that is disputed by a search; a little goes whatever others claim."""
        if self._budget.certain_at(now, use) <= now:
            self.decisions.count(Shortcut.CERTAIN)
            return self.outcomes.send(now, stream, sample, use, CERTAIN)
        standing = self.appraisal.weigh(now, stream, sample)
        if standing is Standing.CONTESTED and in_turn(self._budget, now, use):
            standing = Standing.UNDISPUTED  # nobody else may use that room
        if standing in (Standing.UNDISPUTED, Standing.HOPELESS):
            sends = standing is Standing.UNDISPUTED
            shortcut = Shortcut.UNDISPUTED if sends else Shortcut.HOPELESS
            self.decisions.count(shortcut)
            weighed = self.appraisal.disputes.weighed(stream)
            why = Why("forwarded" if sends else "dropped:planner", shortcut, weighed=weighed)
            if sends:
                return self.outcomes.send(now, stream, sample, use, why)
            return self.outcomes.refuse(now, stream, sample, why)
        if lacking := self.appraisal.lacking_beside_booked(now, use):
            return self.outcomes.refuse(now, stream, sample, Why(CONSTRAINT, "", lacking, BOOKED))
        return self.search.start(now, sample, self._inbox, self._tickets)

    def _decided(self, event: DecisionReady, pending: Pending, plan: Plan) -> list[Command]:
        """Do what the plan says, as far as the limits still have room."""
        now, searched = event.now, pending.searched(plan, cut=event.cut)
        if pending.copy is not None:
            return self._copy_gate.decided(now, pending.copy, searched)
        sample, beside = pending.sample, BOOKED
        stream = self.appraisal.stream_of(now, sample)
        use = self.appraisal.use(stream, sample)
        lacking = self.appraisal.lacking_beside_booked(now, use) if plan.send else ()
        until = now if lacking and pending.ticket == self._overtaken else -math.inf
        if plan.send and not lacking:
            lacking, until = self.appraisal.lacking_beside_rivals(now, stream, use)
            beside = RIVALS
        waits = False
        if plan.send and stream is not None:
            waits = (
                until > -math.inf and self._waits.give_way(now, stream, sample, until)
                if lacking
                else self._waits.for_channel(now, stream, sample)
            )
        if waits:
            self.decisions.log.note(now, sample.key, sample, Why(WAITS, SEARCH, lacking, beside, None, searched))
            return []
        reason = CONSTRAINT if lacking else "forwarded" if plan.send else "dropped:planner"
        self.decisions.note(now, sample.key, reason, searched)
        why = Why(reason, SEARCH, lacking, beside if lacking else "", None, searched)
        if not (plan.send or plan.binding):
            self._budget.hollow.spare(sample.key)
        if reason != "forwarded":
            return [self.outcomes.refuse(now, stream, sample, why)]
        return [self.outcomes.send(now, stream, sample, use, why)]

    def _complain(self, error: str) -> list[Command]:
        """Say loudly that the planner failed, once for each error."""
        before, self._complaint = self._complaint, error
        text = f"the planner failed, a static rule decides: {error}"
        return [Notice("error", text, {"reason": "planner"})] if error != before else []

    def _without_plan(self, now: float, pending: Pending, *, late: bool) -> list[Command]:
        """Decide by priority and token buckets; `late` send what fits, unless something more urgent waits."""
        if pending.copy is not None:
            return self._copy_gate.by_rule(now, pending.copy, self._rule)
        cause = Shortcut.LATE if late else RULE
        sample, stream = pending.sample, self.appraisal.stream_of(now, pending.sample)
        use = self.appraisal.use(stream, sample)
        if late and all(waiting.priority >= sample.priority for waiting in self._inbox):
            lacking = self.appraisal.lacking_beside_booked(now, use)
            lacking = lacking or self.appraisal.lacking_beside_rivals(now, stream, use)[0]
        else:
            lacking = self._rule.admit(now, sample, use)
        if lacking:
            return [self.outcomes.refuse(now, stream, sample, Why("dropped:fallback", cause, lacking))]
        return [self.outcomes.send(now, stream, sample, use, Why("passed:fallback", cause))]
