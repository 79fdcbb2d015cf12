"""One robot that is away, or is back and does not have everything yet, and the copies that are kept for it."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from proxy.core.model.waiting import Waiting
from proxy.core.samples.tuning import TUNING
from proxy.core.view.subscribers import intersects


@dataclass(slots=True, eq=False)
class Copy:
    """A sample kept for the robot with the tag `to`, worth nothing after `until` [s]."""

    waiting: Waiting
    to: str
    until: float
    most: int
    """As many copies of its stream are kept for one robot."""
    delete: bool
    ready_at: float = -math.inf
    """The copy is not looked at before this time [s]."""

    def postpone(self, until: float) -> None:
        """Do not look at the copy before that time [s]."""
        self.ready_at = until

    @property
    def age_order(self) -> tuple[float, int]:
        """Orders copies from the oldest to the newest."""
        return self.waiting.t_gen, self.waiting.sample


@dataclass(frozen=True, slots=True)
class Leaving:
    """A robot whose token vanished, sent a sample of `once` on keys it `reached`; specs `alike` tell it what it has."""

    name: str
    tag: str
    subscriptions: tuple[str, ...]
    reached: frozenset[str]
    alike: bool


class Away:
    """A robot that is kept for; it is `back` when its token is, and `known` when its subscriptions are, too."""

    def __init__(self, now: float, robot: Leaving) -> None:
        self.robot = robot
        self.since = now
        self.back = False
        self.known = False
        self.named: frozenset[str] = frozenset()
        """The keys of which it knows that copies wait for it."""
        self._reminded_at = -math.inf
        self._copies: dict[str, list[Copy]] = {}
        """By key, the oldest first."""
        self._handing: dict[int, Copy] = {}
        """The copies on their way to the mesh session, by the numbers of their samples."""

    def vanish(self, now: float, robot: Leaving) -> None:
        """It has vanished again. As long as it did not tell its subscriptions anew, the earlier ones hold."""
        if self.known:
            self.robot, self.since = robot, now
        self.back = self.known = False
        self.named = frozenset()

    def appear(self) -> None:
        """Its token is back."""
        self.back = True

    def subscribe(self) -> None:
        """It has told its subscriptions: new samples reach it by themselves."""
        self.known = True

    def tell(self, keys: frozenset[str]) -> None:
        """It is told that copies of these keys wait for it."""
        self.named = keys

    def reminds(self, now: float) -> bool:
        """Whether it is to be reminded of what waits for it, as it is from time to time: that is now."""
        due = bool(self.named) and now >= self._reminded_at + TUNING.reminder_every
        self._reminded_at = now if due else self._reminded_at
        return due

    def wants(self, key: str) -> bool:
        """Whether it subscribed to a key."""
        return any(intersects(expression, key) for expression in self.robot.subscriptions)

    def waiting(self) -> Iterator[Copy]:
        """Return the copies that wait."""
        return (copy for copies in self._copies.values() for copy in copies)

    def all(self) -> list[Copy]:
        """Return the copies that wait, and those on their way to the mesh session."""
        return [*self.waiting(), *self._handing.values()]

    def oldest(self) -> Iterator[Copy]:
        """Return the oldest copy of each key that waits."""
        return (copies[0] for copies in self._copies.values())

    def has(self, copy: Copy) -> bool:
        """Whether a copy waits."""
        return any(each is copy for each in self._copies.get(copy.waiting.key, ()))

    @property
    def count(self) -> int:
        """How many copies there are."""
        return len(self._handing) + sum(map(len, self._copies.values()))

    @property
    def keys(self) -> frozenset[str]:
        """The keys of which not all copies are handed over."""
        return frozenset(self._copies) | {copy.waiting.key for copy in self._handing.values()}

    @property
    def reached(self) -> frozenset[str]:
        """The keys of `once` of which it has a sample for certain."""
        return self.robot.reached - self._copies.keys()

    def add(self, copy: Copy) -> Copy | None:
        """Keep one more copy; where that is one too many of its key return the least valuable one."""
        copies = self._copies.setdefault(copy.waiting.key, [])
        copies.append(copy)
        return min(copies, key=_value) if len(copies) > copy.most else None

    def remove(self, copy: Copy) -> None:
        """A copy waits no longer."""
        copies = self._copies[copy.waiting.key]
        copies.remove(copy)
        if not copies:
            del self._copies[copy.waiting.key]

    def hand(self, copy: Copy) -> None:
        """A copy is on its way to the mesh session."""
        self.remove(copy)
        self._handing[copy.waiting.sample] = copy

    def answer(self, sample: int) -> Copy | None:
        """The mesh session has answered; return the copy that it was about, if it is still on its way."""
        return self._handing.pop(sample, None)

    def turn_back(self, copy: Copy) -> None:
        """A copy waits again, as the next one of its key."""
        self._copies.setdefault(copy.waiting.key, []).insert(0, copy)

    def offer_again(self) -> None:
        """Let the copies on their way to the mesh session wait again: nobody knows whether they arrive."""
        for copy in self._handing.values():
            self._copies.setdefault(copy.waiting.key, []).append(copy)
        self._handing = {}
        for copies in self._copies.values():
            copies.sort(key=lambda copy: copy.age_order)


def _value(copy: Copy) -> tuple[bool, float, float, int]:
    """Order the copies of one stream by what they are worth; a deletion is worth most."""
    return copy.delete, copy.waiting.scale, *copy.age_order
