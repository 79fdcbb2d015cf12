"""Shares: who may use how much of each limit, so that the union holds at any latency.

Of every constraint a robot holds an amount, in the constraint's own unit per window: its equal part of the limit,
plus what others granted it, less what it granted. It may use at most that much within any window. Grants are
cumulative counters in digests: the giver counts them at once, the receiver when it hears of them, so that what is on
its way belongs to nobody and the amounts of all robots never sum to more than the limit. Only what is not in use may
be granted. A constraint that is not shared, such as a robot's own energy, it holds whole, whatever the others do.

Equal parts, of the limit less one floor, need agreement on who shares. The *epoch* is a hash of the members and the
limits. Until every member was heard in our epoch, a robot holds the lesser of what it held before and what the epoch
gives it, and grants nothing. A robot not heard keeps its part until membership drops it; a newcomer starts with the
floor.
"""

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field
from zlib import crc32

from proxy.core.limits import Limit
from proxy.core.wire import PARTS, Grant

HOLDABLE = 0.98
"""Part of a limit that one robot can come to hold: all but the floor, with the margin that targets keep."""
EPOCHS = 16
"""Epochs whose grants are remembered, so that a member that flaps finds its ledger again."""


@dataclass(slots=True)
class _Ledger:
    """Cumulative grants of one epoch, by (giver, receiver, constraint): ours, and all that we heard of [`PARTS`]."""

    grants: dict[tuple[str, str, int], int] = field(default_factory=dict)

    def net(self, robot: str, k: int) -> int:
        """Parts that a robot was granted of a constraint, less what it granted."""
        taken = sum(total for (_, to, c), total in self.grants.items() if to == robot and c == k)
        given = sum(total for (by, _, c), total in self.grants.items() if by == robot and c == k)
        return taken - given


class Shares:
    """What this robot holds, uses and grants of every constraint. Peers are named by their tags."""

    def __init__(self, own: str, limits: tuple[Limit, ...], *, floor: float, settled_at: float) -> None:
        self.own = own
        self._limits = limits
        self._factors = [1.0] * len(limits)
        self._floor = floor
        self._settled_at = settled_at
        self._members: frozenset[str] = frozenset((own,))
        self._epochs: dict[str, int] = {}
        self._ledgers: dict[int, _Ledger] = {}
        self._cap: list[float] | None = [floor * limit.limit for limit in limits]
        self._sent: deque[tuple[float, tuple[float, ...]]] = deque()
        self._announced = 0
        self.epoch = 0
        self._enter()

    @property
    def members(self) -> frozenset[str]:
        """Tags of the robots that share, our own included."""
        return self._members

    def set_members(self, now: float, members: Iterable[str]) -> None:
        """The robots on the mesh are now these (ours is added)."""
        changed = frozenset(members) | {self.own}
        if changed != self._members:
            self._cap = [self.held(now, k) for k in range(len(self._limits))]
            self._members = changed
            self._enter()

    def set_limits(self, now: float, limits: tuple[Limit, ...]) -> None:
        """The constraints are now these; what we held of one that stays caps what we hold of it at first."""
        if limits == self._limits:
            return
        before = {_identity(limit): k for k, limit in enumerate(self._limits)}
        places = [before.get(_identity(limit)) for limit in limits]
        self._cap = [
            0.0 if k is None else min(self.held(now, k), limit.limit) for k, limit in zip(places, limits, strict=True)
        ]
        self._sent = deque((t, tuple(0.0 if k is None else use[k] for k in places)) for t, use in self._sent)
        self._limits = limits
        self._factors = [1.0] * len(limits)
        self._enter()

    def set_factor(self, k: int, factor: float) -> None:
        """Only this part of constraint `k` is in force: all amounts are parts of that, in the same epoch."""
        self._factors[k] = factor

    def heard(self, peer: str, epoch: int, grants: Iterable[Grant]) -> None:
        """Take in that `peer` is in `epoch`, and what it granted there."""
        self._epochs[peer] = epoch
        if epoch != self.epoch or peer not in self._members:
            return
        ledger = self._ledgers[epoch].grants
        for grant in grants:
            if grant.constraint < len(self._limits) and grant.peer in self._members:
                place = (peer, grant.peer, grant.constraint)
                ledger[place] = max(grant.total, ledger.get(place, 0))

    def forget(self, peer: str) -> None:
        """A robot left: what it last said of its epoch no longer counts."""
        self._epochs.pop(peer, None)

    def announced(self, now: float) -> int:
        """The epoch to tell the others: ours, once our sends fit what it gives us; until then the one before."""
        if all(self.used(now, k) <= self.held(now, k) for k, limit in enumerate(self._limits) if limit.shared):
            self._announced = self.epoch
        return self._announced

    def confirmed(self, now: float) -> bool:
        """Whether all members are known to be in our epoch."""
        others = self._members - {self.own}
        return now >= self._settled_at and all(self._epochs.get(peer) == self.epoch for peer in others)

    def held(self, now: float, k: int) -> float:
        """What we may use of constraint `k` within any window [its units]."""
        amount = self.held_by(self.own, k)
        if not self._limits[k].shared:
            return amount
        if self._cap is not None:
            if self.confirmed(now):
                self._cap = None
            else:
                amount = min(amount, self._cap[k])
        return max(0.0, amount)

    def held_by(self, robot: str, k: int) -> float:
        """What a member holds of constraint `k` in this epoch, as far as we heard of grants [its units]."""
        amount = self._amount(k)
        if not self._limits[k].shared:
            return amount
        part = (1.0 - self._floor) * amount / len(self._members)
        return part + self._ledgers[self.epoch].net(robot, k) * amount / PARTS

    def used(self, now: float, k: int) -> float:
        """What our sends of the window that ends now use of constraint `k`."""
        since = now - self._limits[k].window
        return sum(use[k] for t, use in self._sent if t >= since)

    def free(self, now: float, k: int) -> float:
        """What we hold of constraint `k` and do not use."""
        return max(0.0, self.held(now, k) - self.used(now, k))

    def fits(self, now: float, use: tuple[float, ...]) -> bool:
        """Whether a message with this use may be sent now."""
        return not self.lacking(now, use)

    def lacking(self, now: float, use: tuple[float, ...]) -> list[int]:
        """Return the constraints that leave no room for a message with this use now."""
        return [k for k, amount in enumerate(use) if not self._fits(now, k, amount)]

    def use(self, now: float, use: tuple[float, ...]) -> None:
        """A message with this use is sent now."""
        self._sent.append((now, use))
        longest = max((self._window(k) for k in range(len(self._limits))), default=0.0)
        while self._sent and self._sent[0][0] < now - longest:
            self._sent.popleft()

    def use_at_most(self, now: float, use: tuple[float, ...], part: float) -> None:
        """Traffic that nobody decided on is sent now; it counts up to `part` of what we hold, the rest is left."""
        room = (part * self.held(now, k) - self.used(now, k) for k in range(len(self._limits)))
        self.use(now, tuple(max(0.0, min(amount, left)) for amount, left in zip(use, room, strict=True)))

    def sent(self) -> tuple[tuple[float, tuple[float, ...]], ...]:
        """Our sends that may still count, as (time, use), oldest first."""
        return tuple(self._sent)

    def grant(self, now: float, peer: str, k: int, amount: float) -> float:
        """Grant `peer` up to `amount` of what is free of constraint `k`; return what it got."""
        limit = self._limits[k]
        if not limit.shared or peer not in self._members or peer == self.own or not self.confirmed(now):
            return 0.0
        parts = max(0, int(min(amount, self.free(now, k)) * PARTS / self._amount(k)))
        if parts > 0:
            grants = self._ledgers[self.epoch].grants
            grants[self.own, peer, k] = grants.get((self.own, peer, k), 0) + parts
        return parts * self._amount(k) / PARTS

    def grants(self) -> tuple[Grant, ...]:
        """All that we granted in this epoch, for the digest."""
        grants = self._ledgers[self.epoch].grants
        return tuple(Grant(to, k, total) for (by, to, k), total in grants.items() if by == self.own)

    def _fits(self, now: float, k: int, amount: float) -> bool:
        """Eq. 5 against what we hold; a message larger than anybody could hold has a window stretched for it."""
        limit = self._limits[k]
        if amount <= (HOLDABLE if limit.shared else 1.0) * self._amount(k):
            return amount <= self.free(now, k)
        since = now - self._stretched(k, amount)
        alone = self.confirmed(now) or not limit.shared
        return alone and not any(t >= since and use[k] > 0.0 for t, use in self._sent)

    def _window(self, k: int) -> float:
        """How far back a send may count: the window, or what the largest message stretched it to."""
        return self._stretched(k, max((use[k] for _, use in self._sent), default=0.0))

    def _stretched(self, k: int, amount: float) -> float:
        """The window in which a message may be alone, if all robots send such messages [s]; at least the window."""
        limit = self._limits[k]
        users = len(self._members) if limit.shared else 1
        return limit.window * max(1.0, amount * users / self._amount(k))

    def _amount(self, k: int) -> float:
        """What is in force of a constraint [its units]."""
        return self._factors[k] * self._limits[k].limit

    def _enter(self) -> None:
        """Enter the epoch of the members and limits as they are now."""
        limits = ",".join(f"{c.name}:{c.window!r}:{c.limit!r}:{c.measure!r}" for c in self._limits if c.shared)
        self.epoch = crc32(f"{' '.join(sorted(self._members))}|{limits}".encode())
        self._ledgers.setdefault(self.epoch, _Ledger())
        while len(self._ledgers) > EPOCHS:
            del self._ledgers[next(e for e in self._ledgers if e != self.epoch)]


def _identity(limit: Limit) -> tuple[str, str]:
    """What makes a constraint the same one under new specs: amounts of another kind are in another unit."""
    return limit.name, limit.measure.kind
