"""The gate: takes the next sample, has it decided, and forwards or drops it with a reason."""

from dataclasses import dataclass

from planner import Constraint, Plan
from proxy.core.commands import Command, Decide, Drop, Forward, Notice
from proxy.core.counts import Counts
from proxy.core.inbox import Evicted, Inbox, Waiting
from proxy.core.limits import Limit, Limits, use_of
from proxy.core.mode import Mode
from proxy.core.settings import CoreSettings
from proxy.core.shares import Shares
from proxy.core.stream import Sent, Stream
from proxy.core.view import SharedView
from proxy.core.window import WindowBuilder

LEAST_HELD = 1e-6
"""A constraint cannot be zero; this is as good."""
URGENT_PRIORITY = 4
"""Zenoh priorities up to this one (`DATA_HIGH`) may use all that is free when the planner fails."""
FALLBACK_PART = 0.5
"""What the others may use of it then."""


@dataclass(frozen=True, slots=True)
class Pending:
    """The sample being decided."""

    ticket: int
    sample: Waiting


class Gate:
    """One decision at a time, so each sees what the one before did."""

    def __init__(
        self, settings: CoreSettings, view: SharedView, shares: Shares, counts: Counts, windows: WindowBuilder
    ) -> None:
        self._settings = settings
        self._view = view
        self._shares = shares
        self._counts = counts
        self._windows = windows
        self.inbox = Inbox(settings.inbox)
        self.mode = settings.mode
        self.limits: tuple[Limit, ...] = ()
        self.pending: Pending | None = None
        self.decisions = 0
        self.iterations = 0
        self.would_drop = 0
        self._complaint = ""
        self._deletes: list[int] = []

    def put(self, waiting: Waiting) -> list[Command]:
        """Queue a sample for its decision; it may evict another one."""
        return self._leave(self.inbox.put(waiting))

    def delete(self, key: str, sample: int) -> list[Command]:
        """A deletion of the key passes, behind what was published before it: never before a sample being decided."""
        commands = self._leave(self.inbox.evict(key))
        if self.pending is not None and self.pending.sample.key == key:
            self._deletes.append(sample)
            return commands
        return [*commands, self.pass_on(sample, "passed:delete")]

    def next(self, now: float, ticket: int) -> list[Command]:
        """Take up samples until one needs a search, or none is left."""
        commands: list[Command] = []
        while self.pending is None and (sample := self.inbox.take()) is not None:
            commands += self._take_up(now, sample, ticket)
        return commands

    def ready(self, now: float, plan: Plan | None, error: str) -> list[Command]:
        """The answer for the pending sample; deletions that came meanwhile follow it."""
        deletes, self._deletes = self._deletes, []
        return [*self._decided(now, plan, error), *(self.pass_on(sample, "passed:delete") for sample in deletes)]

    def _decided(self, now: float, plan: Plan | None, error: str) -> list[Command]:
        pending, self.pending = self.pending, None
        if pending is None:
            return []
        if plan is None:
            return self._fall_back(now, pending, error)
        self.decisions += 1
        self.iterations += plan.iterations
        self._complaint = ""
        if not plan.send:
            return [self._refuse(now, pending.sample, "dropped:planner")]
        use = self._use(now, pending.sample)
        if not self.fits(now, use):
            return [self._refuse(now, pending.sample, "dropped:constraint")]
        return [self._send(now, pending.sample, use, "forwarded")]

    def fits(self, now: float, use: tuple[float, ...]) -> bool:
        """Whether a message may be sent now by every constraint in force."""
        if self._settings.coordination == "shares":
            return self._shares.fits(now, use)
        return all(
            self._known_use(now, limit, k) + amount <= max(limit.limit, amount)
            for k, (limit, amount) in enumerate(zip(self.limits, use, strict=True))
        )

    def problem_limits(self, now: float) -> Limits:
        """Return the constraints of a problem: the union's and, in `shares`, what we hold of them."""
        held = [
            Constraint(f"{c.name} (held)", c.window, max(self._shares.held(now, k), LEAST_HELD))
            for k, c in enumerate(self.limits)
            if self._settings.coordination == "shares"
        ]
        return Limits(self.limits, tuple(held), self._shares.sent())

    def release(self, now: float) -> list[Command]:
        """Let everything that waits pass: the mode is `pass` now."""
        commands: list[Command] = []
        while (sample := self.inbox.take()) is not None:
            commands.append(self.pass_on(sample.sample, "passed:mode"))
            self._shares.use_at_most(now, use_of(sample.size, 1, self.limits), 1.0)
        return commands

    def pass_on(self, sample: int, reason: str) -> Command:
        """Forward a sample that needs no decision."""
        self._counts.approve(sample, reason)
        return Forward(sample)

    def _take_up(self, now: float, sample: Waiting, ticket: int) -> list[Command]:
        stream = self._own(now, sample)
        if stream is None:
            return [self.pass_on(sample.sample, "passed:no-spec")]
        if self._view.receivers(stream) == 0:
            return [self.pass_on(sample.sample, "passed:unwanted")]
        use = self._use(now, sample)
        if not self.limits:
            return [self._send(now, sample, use, "forwarded")]
        if not self.fits(now, use):
            return [self._refuse(now, sample, "dropped:constraint")]
        problem = self._windows.build(now, sample, self.inbox, self.problem_limits(now))
        self.pending = Pending(ticket, sample)
        budget = max(50, self._settings.iterations // (1 + len(self.inbox) // 4))
        return [Decide(ticket, problem, ticket, min(budget, self._settings.iterations))]

    def _fall_back(self, now: float, pending: Pending, error: str) -> list[Command]:
        """The static rule for when the planner fails: priority, and a part of what is free."""
        use = self._use(now, pending.sample)
        doubled = tuple(amount / FALLBACK_PART for amount in use)
        urgent = pending.sample.priority <= URGENT_PRIORITY
        commands: list[Command] = []
        if error != self._complaint:
            commands.append(Notice("error", f"the planner failed, a static rule decides: {error}"))
        self._complaint = error
        if self.fits(now, use if urgent else doubled):
            return [*commands, self._send(now, pending.sample, use, "passed:fallback")]
        return [*commands, self._refuse(now, pending.sample, "dropped:fallback")]

    def _send(self, now: float, sample: Waiting, use: tuple[float, ...], reason: str) -> Command:
        stream = self._own(now, sample)
        if stream is not None:
            sent = Sent(min(sample.t_gen, now), now, sample.size, sample.scale, sample.features)
            stream.note_sent(stream.forwarded + 1, sent)
        self._tell(stream, sample.size)
        self._shares.use(now, use)
        return self.pass_on(sample.sample, reason)

    def _refuse(self, now: float, sample: Waiting, reason: str) -> Command:
        """Drop what was decided against; in `shadow` it goes all the same, and only its traffic is told."""
        if self.mode is not Mode.SHADOW:
            return self._drop(sample.sample, reason)
        self.would_drop += 1
        self._tell(self._own(now, sample), sample.size)
        return self.pass_on(sample.sample, "passed:shadow")

    def _tell(self, stream: Stream | None, size: int) -> None:
        """Count a sample in what we tell others that we put on the air."""
        copies = self._view.copies(stream) if stream is not None else 1
        self._view.aired(copies, copies * size)

    def _leave(self, evicted: Evicted | None) -> list[Command]:
        return [] if evicted is None else [self._drop(evicted.sample, evicted.reason)]

    def _drop(self, sample: int, reason: str) -> Command:
        self._counts.drop(sample, reason)
        return Drop(sample, reason)

    def _own(self, now: float, sample: Waiting) -> Stream | None:
        return self._view.stream(now, self._settings.robot, sample.key)

    def _use(self, now: float, sample: Waiting) -> tuple[float, ...]:
        """What a sample uses of the constraints as they are now: they may change while it is decided."""
        stream = self._own(now, sample)
        return use_of(sample.size, self._view.copies(stream) if stream is not None else 1, self.limits)

    def _known_use(self, now: float, limit: Limit, k: int) -> float:
        """What we know to be sent, by anybody, within the window that ends now."""
        since = now - limit.window
        others = sum(
            limit.measure.use(s.size, self._view.copies(stream), own=False)
            for stream in self._view.streams()
            if stream.robot != self._settings.robot
            for s in stream.recent
            if s.t_sent >= since
        )
        return others + self._shares.used(now, k)
