"""The gate: takes the next sample, has it decided, and forwards or drops it with a reason."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain

from planner import Aggregation, Plan
from proxy.core.coordination.budget import Budget
from proxy.core.coordination.claims import both, leads, news_take, opening, rivals
from proxy.core.interface.commands import Command, Decide, Drop, Forward, Notice, Reread, SendCopy
from proxy.core.interface.events import DecisionReady
from proxy.core.market.disputes import Disputes
from proxy.core.market.prices import Standing
from proxy.core.market.undersubscribed import Ample
from proxy.core.model.limits import Limit, changes_plans, use_of
from proxy.core.model.mode import Mode, in_force
from proxy.core.model.settings import CoreSettings
from proxy.core.model.waiting import Waiting
from proxy.core.protocol.fixed import rounded
from proxy.core.samples.counts import Counts
from proxy.core.samples.decisions import Decided, Decisions
from proxy.core.samples.deletions import Deletions
from proxy.core.samples.fallback import TokenBuckets
from proxy.core.samples.inbox import SUPERSEDED, Evicted, Inbox
from proxy.core.samples.kept import NO_SPEC, ONCE, Copy, Kept
from proxy.core.view.stream import Sent, Stream
from proxy.core.view.view import SharedView
from proxy.core.window.guarantees import guaranteed, owed
from proxy.core.window.span import Span
from proxy.core.window.window import WindowBuilder

AT_ONCE = 128
"""So many samples are taken up at one event: what else happens has its turn before the rest of a burst."""
CONSTRAINT = "dropped:constraint"
GIVES_WAY = 3.0
"""A sample gives way to others' for so many times as long as it waits for room, and is dropped then. With random
sizes 93.8 % of a central decider was reached with 1.0, 95.2 with 3.0, at 20 ms in unicast, but a point less
in broadcast."""
LEAST_WAIT = 1e-3
"""A sample gives way for at least so long [s]."""
MANY_GONE = 64
"""When so many samples left that waited for room they are forgotten."""


@dataclass(frozen=True, slots=True)
class Pending:
    """The sample being decided, or the copy of one, beside so many other messages; of too many some were left out."""

    ticket: int
    sample: Waiting
    constraints: tuple[str, ...]
    held: int = 0
    thinned: bool = False
    copy: Copy | None = None


class Gate:
    """One decision at a time, so each sees what the one before did."""

    def __init__(
        self, settings: CoreSettings, view: SharedView, budget: Budget, counts: Counts, windows: WindowBuilder
    ) -> None:
        self._settings = settings
        self._view = view
        self._budget = budget
        self._counts = counts
        self._windows = windows
        self.inbox = Inbox(settings.inbox, settings.backlog, settings.inbox_bytes)
        self.kept = Kept(settings.away)
        """Copies for robots that are away."""
        self.mode = settings.mode
        self.pending: Pending | None = None
        self.decisions = Decisions()
        self.span = Span(settings.deadline)
        self._complaint = ""
        self._buckets = TokenBuckets()
        self._deletions = Deletions()
        self.wakes_at = math.inf
        """When a sample that waits for room can be taken up [s]."""
        self._opening: dict[int, tuple[float, tuple[Limit, ...]]] = {}
        """When there is room for samples that wait for it [s], under which limits."""
        self._unsettled: dict[int, Waiting] = {}
        """Samples whose worth by the specs in force is not known yet."""
        self._ample = Ample(view)
        self._first: dict[int, tuple[Stream, tuple[str, ...]]] = {}
        """Samples of `once` on their way to the mesh session, and to whom each is the first of its stream."""

    def mode_of(self, stream: Stream | None) -> Mode:
        """What is done with decisions on a stream."""
        return self.mode if stream is None else in_force(self.mode, stream.information_type.mode)

    @property
    def limits(self) -> tuple[Limit, ...]:
        """The constraints in force for all robots together."""
        return self._budget.limits

    def put(self, now: float, waiting: Waiting) -> list[Command]:
        """Queue a sample. Where too many wait all go at once if the limits have room for them; if not, one leaves."""
        if self.pending is not None and (stream := self._own(now, waiting)) is not None:
            self._ample.note(now, stream)
        room = self.inbox.full(waiting) and self._takes_all(now, waiting)
        sent = self._send_all(now) if room else []
        return [*sent, *self._leave(self.inbox.put(waiting)), *self._delete()]

    def _takes_all(self, now: float, waiting: Waiting) -> bool:
        """Whether all that is undecided may be sent now by every constraint in force, and one more sample."""
        left = self._budget.free(now)
        for each in (waiting, *self._undecided()):
            left = [room - amount for room, amount in zip(left, self._use(now, each), strict=True)]
            if min(left, default=0.0) < 0.0:
                return False
        return True

    def _send_all(self, now: float) -> list[Command]:
        """Send all that waits, what is being decided before it."""
        commands: list[Command] = []
        deciding, self.pending = self._deciding(), None
        sample = deciding[0] if deciding else self.inbox.take(self._deletions.holds)
        while sample is not None:
            commands += [*self._take_up(now, sample, None), *self._delete()]
            sample = self.inbox.take(self._deletions.holds)
        return commands

    def unsettle(self) -> list[Command]:
        """Take back all that is undecided: specs changed, and no decision may mix what two of them say."""
        taken = [*self.inbox.clear(), *self._deciding()]
        self.pending = None
        self._unsettled |= {waiting.sample: waiting for waiting in taken}
        return [Reread(each.sample, each.key) for each in self._unsettled.values()]

    def settled(self, sample: int) -> Waiting | None:
        """Return a sample that was taken back, for it to be `put` again; None when it has left meanwhile."""
        return self._unsettled.pop(sample, None)

    def supersede(self, waiting: Waiting) -> list[Command] | None:
        """Drop a sample that was taken back if a newer one of its Markovian stream came meanwhile; else None."""
        newer = any(each.key == waiting.key and each.t_gen > waiting.t_gen for each in self._undecided())
        if not (newer and waiting.markovian):
            return None
        return [*self._leave([Evicted(waiting.sample, SUPERSEDED, waiting.key)]), *self._delete()]

    def delete(self, key: str, sample: int) -> list[Command]:
        """A deletion of the key passes, behind what was published before it and is still undecided."""
        commands = self._leave(self.inbox.supersede(key))
        self._deletions.add(sample, key, self._undecided())
        return [*commands, *self._delete()]

    def next(self, now: float, ticket: int) -> list[Command]:
        """Take up samples until one needs a search, or none is left."""
        commands: list[Command] = []
        self.wakes_at = math.inf
        if len(self._opening) > 2 * len(self.inbox) + MANY_GONE:
            here = {waiting.sample for waiting in self.inbox}
            self._opening = {sample: t for sample, t in self._opening.items() if sample in here}
        if not self.inbox and not self.kept:
            return commands
        crowded = False
        for _ in range(AT_ONCE):
            if self.pending is not None:
                break
            if not crowded and (copy := self._foremost(now)) is not None:
                commands += self._take_up_copy(now, copy, ticket)
                crowded = self.pending is None and self.kept.waits(copy)
            elif (sample := self.inbox.take(partial(self._waits, now))) is not None:
                commands += [*self._take_up(now, sample, ticket), *self._delete()]
            else:
                break
        else:
            self.wakes_at = now
        if self.kept:
            self.wakes_at = min(self.wakes_at, self.kept.next_at(now))
        return commands

    def _foremost(self, now: float) -> Copy | None:
        """Return the copy that is decided before all that waits in the inbox: of one priority it is the older one."""
        copy = self.kept.foremost(now)
        return None if copy is None or any(w.priority < copy.waiting.priority for w in self.inbox) else copy

    def ready(self, event: DecisionReady) -> list[Command]:
        """The answer for the pending sample, if that is still awaited; deletions that came meanwhile follow it."""
        pending = self._answered(event.ticket)
        if pending is None:
            return []
        self.span.note(pending.held, event.overhead, thinned=pending.thinned)
        return [*self._decided(event.now, pending, event.plan, event.error), *self._delete()]

    def overdue(self, now: float, ticket: int) -> list[Command]:
        """There is no answer in time for the pending sample: what fits is sent at once."""
        pending = self._answered(ticket)
        if pending is None:
            return []
        self.span.note(pending.held, math.inf, thinned=pending.thinned)
        self.decisions.late += 1
        return [*self._undecided_in_time(now, pending), *self._delete()]

    def handed(self, now: float, sample: int) -> None:
        """The mesh session took the sample."""
        self._first.pop(sample, None)
        self._budget.handed(now, sample)

    def refused(self, sample: int) -> None:
        """The mesh session did not take the sample: if it is the first one that counts, the next one is."""
        self._budget.refused(sample)
        first = self._first.pop(sample, None)
        if first is not None:
            stream, names = first
            stream.miss(names)

    def _answered(self, ticket: int) -> Pending | None:
        """Return what waits for the answer with this ticket, and does so no longer."""
        if self.pending is None or self.pending.ticket != ticket:
            return None
        pending, self.pending = self.pending, None
        return pending

    def _decided(self, now: float, pending: Pending, plan: Plan | None, error: str) -> list[Command]:
        if plan is None:
            return self._fall_back(now, pending, error)
        self._complaint = ""
        if pending.copy is not None:
            return self._decided_copy(now, pending, pending.copy, plan)
        use = self._use(now, pending.sample)
        lacking = self._budget.lacking(now, self._windows.disputes.besides(now, use)) if plan.send else ()
        if plan.send and not lacking:
            lacking, until = self._lacking_beside_rivals(now, pending.sample, use)
            if lacking and self._gives_way(now, pending.sample, until):
                return []
        reason = CONSTRAINT if lacking else "forwarded" if plan.send else "dropped:planner"
        self.decisions.note(Decided(now, pending.sample.key, plan, pending.constraints, reason))
        if reason != "forwarded":
            return [self._refuse(now, pending.sample, reason, lacking)]
        return [self._send(now, pending.sample, use, reason)]

    def release(self, now: float) -> list[Command]:
        """Let everything that waits pass, and what is being decided before it: the mode is `pass` now."""
        commands: list[Command] = []
        self.inbox.put_back(self._unsettled.values())
        self._unsettled.clear()
        deciding, self.pending = self._deciding(), None
        sample = deciding[0] if deciding else self.inbox.take(self._deletions.holds)
        while sample is not None:
            commands += [self.pass_on(sample.sample, "passed:mode"), *self._delete()]
            self._budget.use_at_most(now, use_of(sample.size, 1, self.limits), 1.0)
            sample = self.inbox.take(self._deletions.holds)
        return commands

    def pass_on(self, sample: int, reason: str) -> Command:
        """Forward a sample that needs no decision."""
        self._counts.approve(sample, reason)
        return Forward(sample)

    def _take_up(self, now: float, sample: Waiting, ticket: int | None) -> list[Command]:
        """Decide a sample as far as that needs no search; with a `ticket` it may be searched for."""
        stream = self._own(now, sample)
        if stream is None:
            return [self.pass_on(sample.sample, "passed:no-spec")]
        if self._view.receivers(stream) == 0:
            return [self._unwanted(now, sample)]
        use = self._use(now, sample)
        if self.limits and not self._view.gaining(stream):
            return [self._refuse(now, sample, "dropped:once")]
        must = self._owed(now, stream, sample)
        if lacking := self._budget.lacking(now, use):
            self.decisions.unkept += must
            return [self._refuse(now, sample, CONSTRAINT, lacking)]
        if must:
            self.decisions.owed += 1
        elif ticket is None or self._roomy(now, stream):
            self.decisions.unneeded += bool(self.limits)
        else:
            return [self._weigh(now, stream, sample, use, ticket)]
        return [self._send(now, sample, use, "forwarded")]

    def _weigh(self, now: float, stream: Stream, sample: Waiting, use: tuple[float, ...], ticket: int) -> Command:
        """Decide by what room costs, or where that is disputed by a search."""
        standing = self._standing(now, stream, sample)
        if standing is Standing.UNDISPUTED:
            self.decisions.undisputed += 1
            return self._send(now, sample, use, "forwarded")
        if standing is Standing.HOPELESS:
            self.decisions.hopeless += 1
            return self._refuse(now, sample, "dropped:planner")
        if lacking := self._budget.lacking(now, self._windows.disputes.besides(now, use)):
            return self._refuse(now, sample, CONSTRAINT, lacking)
        return self._search(now, sample, ticket)

    def _take_up_copy(self, now: float, copy: Copy, ticket: int) -> list[Command]:
        """Send a copy, or have it decided; while there is no room for it, it waits for as long as it is worth it."""
        stream = self._own(now, copy.waiting)
        if stream is None or stream.information_type.markovian:
            self.kept.give_up(copy, NO_SPEC)
            return []
        once = stream.information_type.aggregation is Aggregation.ONCE and not copy.delete
        if once and copy.to in stream.reached:
            self.kept.give_up(copy, ONCE)
            return []
        use = self._use_of_copy(copy)
        enforced = self.mode_of(stream) is Mode.ENFORCE
        if enforced and self._budget.lacking(now, self._besides(now, use)):
            return []
        if not enforced or copy.delete or self._roomy(now, stream):
            return [self._send_copy(now, copy, use)]
        scale = rounded(stream.information_type.scale(copy.waiting.features))
        return [self._search(now, replace(copy.waiting, scale=scale, to=copy.to), ticket, copy)]

    def _decided_copy(self, now: float, pending: Pending, copy: Copy, plan: Plan | None) -> list[Command]:
        """The answer for a copy: what is not sent now may be later, when there is more room."""
        if not self.kept.waits(copy):
            return []
        use, rule = self._use_of_copy(copy), self._view.specs.fallback
        urgent = plan is not None or copy.waiting.priority <= rule.urgent
        needed = use if urgent else tuple(amount / rule.part for amount in use)
        send = (plan is None or plan.send) and not self._budget.lacking(now, self._besides(now, needed))
        if plan is not None:
            reason = "forwarded" if send else "waits"
            self.decisions.note(Decided(now, copy.waiting.key, plan, pending.constraints, reason))
        if send:
            return [self._send_copy(now, copy, use)]
        self.kept.postpone(now, copy)
        return []

    def _send_copy(self, now: float, copy: Copy, use: tuple[float, ...]) -> Command:
        stream = self._own(now, copy.waiting)
        if stream is not None and stream.information_type.aggregation is Aggregation.ONCE:
            stream.resume(copy.to)
        self._view.aired(1 + self._settings.relayed, (1 + self._settings.relayed) * copy.waiting.size)
        if self.mode_of(stream) is Mode.ENFORCE:
            self._budget.use(now, use)
        else:
            self._budget.use_at_most(now, use, 1.0)
        self.kept.hand(copy)
        return SendCopy(copy.waiting.sample, copy.to)

    def _besides(self, now: float, use: tuple[float, ...]) -> tuple[float, ...]:
        """What a copy needs: what it uses, and the room that is booked for samples and not used yet.

        Else the copies for who was away cost the others their alarms: 21 and 26 of 60, where copies took half of a
        limit for 2 s.
        """
        return self._disputes(now).besides(now, use)

    def _use_of_copy(self, copy: Copy) -> tuple[float, ...]:
        """What a copy uses of the constraints: it goes to one robot, and when relayed to the router before."""
        return use_of(copy.waiting.size, 1 + self._settings.relayed, self.limits)

    def _search(self, now: float, sample: Waiting, ticket: int, copy: Copy | None = None) -> Command:
        """Have a sample decided, or the copy of one."""
        problem, full = self._windows.within(now, sample, self.inbox, self._budget.problem_limits(now), self.span.most)
        held = sum(not message.sent for message in problem.messages) - 1
        thinned = self.span.most < full
        if thinned:
            self.decisions.thin(held, full)
        self.pending = Pending(ticket, sample, tuple(c.name for c in problem.constraints), held, thinned, copy)
        budget = max(50, self._settings.iterations // (1 + len(self.inbox) // 4))
        return Decide(ticket, problem, ticket, min(budget, self._settings.iterations), now)

    def _standing(self, now: float, stream: Stream, sample: Waiting) -> Standing:
        """How a sample stands among all that competes with it."""
        return self._disputes(now).standing(now, stream, sample)

    def _disputes(self, now: float) -> Disputes:
        """Return how streams stand, weighed anew if it is time to."""
        self._windows.disputes.look(now, self._budget.usable(now), alone=self._budget.alone)
        return self._windows.disputes

    def _owed(self, now: float, stream: Stream, sample: Waiting) -> bool:
        """Whether a guarantee of the stream demands the sample."""
        return guaranteed(stream) and any(owed(stream, [sample.t_gen], self._view.audiences.of(now, stream).slowest))

    def _roomy(self, now: float, stream: Stream) -> bool:
        """Whether there is room for all that may be sent: then nothing is gained by dropping anything."""
        whole = [limit.limit for limit in self._budget.usable(now)]
        alone = self._budget.alone
        return not self.limits or self._ample.fits(now, stream, self.limits, whole, len(self.inbox), alone=alone)

    def _unwanted(self, now: float, sample: Waiting) -> Command:
        """Nobody wants it that we know of: it takes nothing, unless it is for robots that did not tell us yet."""
        if silent := self._view.untold:
            self._budget.use_at_most(now, use_of(sample.size, silent, self.limits), 1.0)
        return self.pass_on(sample.sample, "passed:unwanted")

    def _fall_back(self, now: float, pending: Pending, error: str) -> list[Command]:
        """Say loudly that the planner failed, and decide without it."""
        commands: list[Command] = []
        if error != self._complaint:
            commands.append(Notice("error", f"the planner failed, a static rule decides: {error}"))
        self._complaint = error
        return [*commands, *self._by_rule(now, pending)]

    def _undecided_in_time(self, now: float, pending: Pending) -> list[Command]:
        """Send what fits, unless something more urgent waits: what is not used now is lost."""
        sample, use = pending.sample, self._use(now, pending.sample)
        if pending.copy is not None or any(waiting.priority < sample.priority for waiting in self.inbox):
            return self._by_rule(now, pending)
        needed = self._windows.disputes.besides(now, use)
        if lacking := self._budget.lacking(now, needed) or self._lacking_beside_rivals(now, sample, use)[0]:
            return [self._refuse(now, sample, "dropped:fallback", lacking)]
        return [self._send(now, sample, use, "passed:fallback")]

    def _by_rule(self, now: float, pending: Pending) -> list[Command]:
        """Decide by priority and token buckets."""
        if pending.copy is not None:
            return self._decided_copy(now, pending, pending.copy, None)
        rule, use, buckets = self._view.specs.fallback, self._use(now, pending.sample), self._buckets
        buckets.fill(now, self.limits, [rule.part * room for room in self._budget.left(now)])
        urgent = pending.sample.priority <= rule.urgent
        needed = use if urgent else tuple(amount / rule.part for amount in use)
        if lacking := self._budget.lacking(now, needed) or (() if urgent else buckets.lacking(use)):
            return [self._refuse(now, pending.sample, "dropped:fallback", lacking)]
        if not urgent:
            buckets.take(use)
        return [self._send(now, pending.sample, use, "passed:fallback")]

    def _send(self, now: float, sample: Waiting, use: tuple[float, ...], reason: str) -> Command:
        stream = self._own(now, sample)
        if stream is not None:
            sent = Sent(min(sample.t_gen, now), now, sample.size, sample.scale, sample.features)
            if stream.information_type.aggregation is Aggregation.ONCE:
                self._first[sample.sample] = stream, self._view.gaining(stream)
            self._view.note_sent(stream, stream.forwarded + 1, sent)
            stream.fates[reason] += 1
        self._tell(stream, sample.size)
        self._budget.use(now, use, sample.sample)
        return self.pass_on(sample.sample, reason)

    def _refuse(self, now: float, sample: Waiting, reason: str, lacking: tuple[str, ...] = ()) -> Command:
        """Drop what was decided against; in `shadow` it goes all the same, and only its traffic is told."""
        self.decisions.refused(lacking)
        stream = self._own(now, sample)
        if stream is not None:
            stream.fates[reason] += 1
        if self.mode_of(stream) is not Mode.SHADOW:
            return self._drop(sample.sample, reason)
        self.decisions.would_drop += 1
        self._tell(stream, sample.size)
        specs = self._view.specs
        if "enforce" in specs.modes or self.mode is Mode.ENFORCE:  # what is enforced has to do with what is left
            self._budget.use_at_most(now, self._use(now, sample), 1.0 - specs.floor)
        return self.pass_on(sample.sample, "passed:shadow")

    def _tell(self, stream: Stream | None, size: int) -> None:
        """Count a sample in what we tell others that we put on the air."""
        copies = self._view.copies(stream) if stream is not None else 1
        self._view.aired(copies, copies * size)

    def _leave(self, evicted: Iterable[Evicted]) -> list[Command]:
        commands: list[Command] = []
        for each in evicted:
            stream = self._view.known(self._settings.robot, each.key)
            if stream is not None:
                stream.fates[each.reason] += 1
            commands.append(self._drop(each.sample, each.reason))
        return commands

    def _delete(self) -> list[Command]:
        """Pass the deletions that have nothing before them any more."""
        return [self.pass_on(sample, "passed:delete") for sample in self._deletions.due(self._undecided())]

    def _undecided(self) -> Iterator[Waiting]:
        return chain(self.inbox, self._unsettled.values(), self._deciding())

    def _deciding(self) -> list[Waiting]:
        """The sample that is being decided, if one is; a copy stays where it is kept."""
        return [] if self.pending is None or self.pending.copy is not None else [self.pending.sample]

    def _drop(self, sample: int, reason: str) -> Command:
        self._counts.drop(sample, reason)
        return Drop(sample, reason)

    def _own(self, now: float, sample: Waiting) -> Stream | None:
        return self._view.stream(now, self._settings.robot, sample.key)

    def _use(self, now: float, sample: Waiting) -> tuple[float, ...]:
        """What a sample uses of the constraints as they are now: they may change while it is decided."""
        stream = self._own(now, sample)
        return use_of(sample.size, self._view.copies(stream) if stream is not None else 1, self.limits)

    def _lacking_beside_rivals(
        self, now: float, sample: Waiting, use: tuple[float, ...]
    ) -> tuple[tuple[str, ...], float]:
        """Name the limits that have no room for a sample beside what others with a better claim may just have sent.

        And say until when at least, as far as nothing is heard of them [s].
        """
        stream = self._own(now, sample)
        if stream is None or self._budget.alone or not self._view.peers:
            return (), math.inf
        if any(amount > c.limit for amount, c in zip(use, self._budget.usable(now), strict=True)):
            return (), math.inf  # there never is room beside it
        disputes = self._windows.disputes
        grew = self._budget.grew(now)
        taken, until = rivals(now, self._view, disputes, stream, self.limits, own=use, grew=grew)
        return self._budget.lacking(now, disputes.besides(now, both(use, taken))) if any(taken) else (), until

    def _gives_way(self, now: float, sample: Waiting, until: float) -> bool:
        """Whether a sample waits until it is known what others have sent; not where a newer one is there by then."""
        stream = self._own(now, sample)
        known_at = max(now + LEAST_WAIT, min(until, now + news_take(self._view)))
        if stream is None or any(waiting.key == sample.key for waiting in self.inbox):
            return False
        if known_at > sample.t_gen + GIVES_WAY * self._windows.disputes.patience(stream):
            return False
        self._opening[sample.sample] = known_at, self.limits
        self.inbox.put_back([sample])
        return True

    def _waits(self, now: float, sample: Waiting) -> bool:
        """Whether a sample is not taken up yet: something goes before it, or room for it opens soon."""
        if self._deletions.holds(sample):
            return True
        return bool(self.limits) and (self._waits_for_greetings(now, sample) or self._waits_for_room(now, sample))

    def _waits_for_greetings(self, now: float, sample: Waiting) -> bool:
        """Whether a large sample waits for what robots that have just been met sent lately.

        Who joined or met others again sent its first frame beside two of theirs, and the window held 1.4 limits.
        """
        until = self._view.greeted_by(now)
        if now >= until or self._budget.alone or self.mode_of(self._own(now, sample)) is not Mode.ENFORCE:
            return False
        if not changes_plans(self._use(now, sample), self.limits):
            return False
        self.wakes_at = min(self.wakes_at, until)
        return True

    def _waits_for_room(self, now: float, sample: Waiting) -> bool:
        """Whether a sample waits, as what we sent leaves room for it soon.

        Under the same limits no room opens earlier than it seemed to.
        """
        opens_at, limits = self._opening.get(sample.sample, (-math.inf, self.limits))
        if now >= opens_at or limits != self.limits:
            opens_at = self._room_opens(now, sample)
            self._opening[sample.sample] = opens_at, self.limits
        if now >= opens_at:
            del self._opening[sample.sample]
            return False
        self.wakes_at = min(self.wakes_at, opens_at)
        return True

    def _room_opens(self, now: float, sample: Waiting) -> float:
        """Return when there is room for a sample that is worth waiting for it; −∞ where it is taken up now."""
        stream, disputes = self._own(now, sample), self._windows.disputes
        if stream is None or self.mode_of(stream) is not Mode.ENFORCE or not self._view.gaining(stream):
            return -math.inf
        standing = self._standing(now, stream, sample)
        until = sample.t_gen + disputes.patience(stream, standing)
        if standing is Standing.HOPELESS or now >= until:
            return -math.inf
        needed, anybodys, later = self._use(now, sample), standing is Standing.UNDISPUTED, 0.0
        if standing is Standing.CONTESTED:
            needed = disputes.besides(now, needed)
            if not self._budget.alone and leads(now, self._view, disputes, stream, self.limits):
                anybodys, later = True, opening(self._view)
        room = self._budget.opens(now, needed, anybodys=anybodys)
        if room > now:
            room += later
        return room if room < math.inf and room <= until else -math.inf
