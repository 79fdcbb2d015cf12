"""What may still be sent: the constraints in force, what already counts against them, and which part of each is ours.

Where all plan for all (`announce`), everything known to be sent counts, whoever sent it. Where each robot has a part of
every limit (`split`), only what it sends itself counts against its part. What robots do not share, such as their own
energy, each has whole.
"""

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import replace

from proxy.core.coordination.coordination import Coordination
from proxy.core.market.room import opens
from proxy.core.model.limits import Limit, Limits, Send, changes_plans, longest_window, use_of
from proxy.core.view.view import Amount, SharedView

LEAST = 1e-6
"""A constraint cannot be zero; this is as good."""
NEWER, LONGEST = 0.1, 0.02
"""How long large samples take to leave: the last one has this weight unless it took longer; at most so long [s]."""
MOST_STRETCHED = 16.0
"""Sends are remembered for so many windows at most: the window of a larger message is not stretched further."""


class Budget:
    """The limits in force, and what is left of them. Constraints are named by their places in `limits`."""

    def __init__(self, view: SharedView, coordination: Coordination) -> None:
        self._view = view
        self._coordination = coordination
        self.limits: tuple[Limit, ...] = ()
        """The constraints in force for all robots together, adaptive ones as the channel bears them."""
        self._sent: deque[Send] = deque()
        self._leaving: dict[int, Send] = {}
        """Of what we sent, large samples that the mesh has not taken yet."""
        self._takes = 0.0
        """How long after their decision large samples leave, at most, as far as the last ones tell [s]."""
        self._usable_for: tuple[tuple[Limit, ...], tuple[float, ...]] = (), ()
        self._usable: tuple[Limit, ...] = ()
        self._others_known: tuple[float, int, tuple[Limit, ...], bool] = (-math.inf, 0, (), False)
        """When, after how many notes, under which limits and in which coordination others had sent `_others_sent`."""
        self._others_sent: tuple[Send, ...] = ()

    @property
    def alone(self) -> bool:
        """Whether what may be used is our part, so that only our own streams compete for it."""
        return self._coordination.splits

    def set_limits(self, limits: tuple[Limit, ...]) -> None:
        """Put these constraints in force; what we sent still counts against those of the same name and kind."""
        if limits == self.limits:
            return
        before = {_identity(limit): k for k, limit in enumerate(self.limits)}
        places = [before.get(_identity(limit)) for limit in limits]
        if places != list(range(len(self.limits))):
            self._sent = deque((t, tuple(0.0 if k is None else use[k] for k in places)) for t, use in self._sent)
            self._leaving.clear()
        self.limits = limits

    def whole(self, now: float, k: int) -> float:
        """What may be used within the window that ends now, by us in `split`, else by all [units of the constraint]."""
        limit = self.limits[k]
        return max(LEAST, limit.limit * self._coordination.part(now, k)) if limit.shared else limit.limit

    def usable(self, now: float) -> tuple[Limit, ...]:
        """The constraints as they bind us now."""
        wholes = tuple(self.whole(now, k) for k in range(len(self.limits)))
        known = self.limits, wholes
        if known != self._usable_for:
            self._usable_for = known
            self._usable = tuple(replace(c, limit=whole) for c, whole in zip(self.limits, wholes, strict=True))
        return self._usable

    def used(self, now: float, k: int) -> float:
        """What our own sends of the window that ends now use."""
        since = now - self.limits[k].window
        return sum(use[k] for t, use in self._sent if t >= since)

    def using(self, now: float) -> float:
        """What part our own sends of the windows that end now take of what we may use of shared constraints."""
        shared = (k for k, limit in enumerate(self.limits) if limit.shared)
        return max((self.used(now, k) / self.whole(now, k) for k in shared), default=0.0)

    def free(self, now: float) -> list[float]:
        """What may still be sent now of each constraint; less than nothing where too much was sent."""
        others = self.others(now)
        return [self.whole(now, k) - self._counted(now, k, limit.window, others) for k, limit in enumerate(self.limits)]

    def left(self, now: float) -> list[float]:
        """What we may use of each constraint within the window that ends now, our own sends included."""
        return [max(0.0, room + self.used(now, k)) for k, room in enumerate(self.free(now))]

    def fits(self, now: float, use: tuple[float, ...]) -> bool:
        """Whether a message with this use may be sent now."""
        return not self.lacking(now, use)

    def lacking(self, now: float, use: tuple[float, ...]) -> tuple[str, ...]:
        """Name the constraints that leave no room for a message with this use now."""
        if now < self._coordination.mute_until and changes_plans(use, self.limits):
            return tuple(limit.name for limit in self.limits if limit.shared)
        others = self.others(now)
        return tuple(
            limit.name
            for k, (limit, amount) in enumerate(zip(self.limits, use, strict=True))
            if not self._fits(now, k, amount, others)
        )

    def opens(self, now: float, use: tuple[float, ...], *, anybodys: bool = False) -> float:
        """When the room opens for a message that our sends, or `anybodys`, leave [s]; −∞ where it is there, else ∞.

        Or when our part grows that is too small for it, as a slot was passed on to us: ten robots with equal messages
        reached 82 to 93 % of a central decider in `split` where such a sample was dropped, and reach 83 to 95 now.
        """
        opening = opens(self.usable(now), self._sent, self.others(now), use, anybodys=anybodys)
        if opening < math.inf or math.isinf(grows := self._coordination.grows_at(now)):
            return opening
        return max(grows, opens(self.usable(grows), self._sent, self.others(now), use, anybodys=anybodys))

    def grew(self, now: float) -> float:
        """When a window was left last by a send that changes plans [s]; −∞ where none was."""
        longest = longest_window(limit for limit in self.limits if limit.shared)
        sends = (*self._sent, *self.others(now))
        gone = [t + longest for t, use in sends if t + longest <= now and changes_plans(use, self.limits)]
        return max(gone, default=-math.inf)

    def use(self, now: float, use: tuple[float, ...], sample: int | None = None) -> None:
        """A message with this use is sent now, a `sample` or something else."""
        send = now, use
        self._sent.append(send)
        if sample is not None and changes_plans(use, self.limits):
            self._leaving[sample] = send
        shared = [(amount, limit) for amount, limit in zip(use, self.limits, strict=True) if limit.shared]
        self._coordination.sent(now, [amount / limit.limit for amount, limit in shared])
        while self._sent and self._sent[0][0] < self._remembered_since(now):
            self._sent.popleft()

    def handed(self, now: float, sample: int) -> None:
        """The mesh took a sample: a large one counts for a window from now on, not from when it was decided.

        Where the next one was sent a window after the decision, one window in four of ten flights of a robot alone
        held 1.23 to 1.31 limits, as this one had taken some ms longer to leave.
        """
        send = self._leaving.pop(sample, None)
        if send is not None and send in self._sent:
            self._sent.remove(send)
            self._sent.append((now, send[1]))
            took = now - send[0]
            self._takes = min(max(took, (1.0 - NEWER) * self._takes + NEWER * took), LONGEST)

    def refused(self, sample: int) -> None:
        """The mesh did not take a sample."""
        self._leaving.pop(sample, None)

    def use_at_most(self, now: float, use: tuple[float, ...], part: float) -> None:
        """Traffic that nobody decided on is sent now; it counts up to `part` of what is ours, the rest is left."""
        room = (part * self.whole(now, k) - self.used(now, k) for k in range(len(self.limits)))
        self.use(now, tuple(max(0.0, min(amount, left)) for amount, left in zip(use, room, strict=True)))

    def others(self, now: float) -> tuple[Send, ...]:
        """What we know others to have sent, as far as it counts; in `split` they have their own parts."""
        known = now, self._view.sends_noted, self.limits, self.alone
        if known != self._others_known:
            self._others_known, self._others_sent = known, () if known[3] else self._sent_by_others(now)
        return self._others_sent

    def problem_limits(self, now: float) -> Limits:
        """Return the constraints of a problem, and what was sent that still counts."""
        since = now - longest_window(self.limits)
        own = tuple(each for each in self._sent if each[0] >= since)
        others = () if self.alone else self._uses(now, self._view.sent_since(since))
        return Limits(self.usable(now), own, others, alone=self.alone)

    def _fits(self, now: float, k: int, amount: float, others: tuple[Send, ...]) -> bool:
        """Eq. 5; a message larger than what may be used at all has a window stretched for it, and is alone in that."""
        limit, whole = self.limits[k], self.whole(now, k)
        if amount <= whole:
            return self._counted(now, k, limit.window, others) + amount <= whole
        if limit.shared and not self._coordination.whole_turn(now, k):
            return False
        stretched = limit.window * min(amount / whole, MOST_STRETCHED)
        # What robots tell each other goes on beside it.
        samples = () if self.alone else self._uses(now, self._view.sent_since(now - stretched))
        return self._counted(now, k, stretched, samples) <= 0.0

    def _counted(self, now: float, k: int, window: float, others: tuple[Send, ...]) -> float:
        since = now - window
        own = sum(use[k] for t, use in self._sent if t >= since)
        return own + sum(use[k] for t, use in others if t >= since)

    def _remembered_since(self, now: float) -> float:
        return now - MOST_STRETCHED * longest_window(self.limits)

    def _sent_by_others(self, now: float) -> tuple[Send, ...]:
        return self._uses(now, [*self._view.sent_since(self._remembered_since(now)), *self._view.talk])

    def _uses(self, now: float, sent: Sequence[tuple[float, Amount]]) -> tuple[Send, ...]:
        """Return what this used of each limit that others sent.

        They tell when they decided, and their samples take as long to leave as ours: where who waited for their room
        sent a window after the decision, windows of eight busy daemons held up to 1.3 limits.
        """
        alike = {amount: use_of(*amount, self.limits, own=False) for amount in {amount for _, amount in sent}}
        return tuple([(min(t + self._takes, max(t, now)), alike[amount]) for t, amount in sent])


def _identity(limit: Limit) -> tuple[str, str]:
    """What makes a constraint the same one under new specs: amounts of another kind are in another unit."""
    return limit.name, limit.measure.kind
