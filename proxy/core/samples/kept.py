"""Copies for robots that are away, of samples of which each counts, until their robot is back or gone.

A robot is away when its presence token has vanished. That is noticed late: what was sent shortly before may not have
arrived, so it is offered again, and the robot leaves out what it has. When the robot is back, each copy is decided like
any other sample, for this robot alone, the older ones first. A copy is given up when it is worth nothing any more, when
there are too many, or when the robot is gone.

What is kept here are numbers; the driver has the payloads: it keeps one from `Keep` until `Forget`.
"""

import math
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from proxy.core.interface.commands import Command, Forget, Keep, TellBacklog
from proxy.core.model.waiting import Waiting
from proxy.core.view.interest import intersects

DOUBT = 14.0
"""What was decided so shortly before a loss was noticed may not have arrived [s]: Zenoh's lease of 10 s, where the
other end's kernel answers and nobody reads, and what waits in the buffers of a slow channel, which hide 3.8 s."""
RETRY = 0.25
"""A copy that a plan was against is decided again so much later [s]."""
LOOK = 0.05
"""It is looked this often whether there is room for copies [s]."""
MOST_ROBOTS = 64
"""Robots that are kept for at once; of more, the one that left first is gone."""
MOST_COPIES = 8192
"""Copies in all."""
MOST_BYTES = 16 * 1024 * 1024
"""Bytes of the samples kept, each counted once [B]."""
AGAIN = 1.0
"""A robot that is back is told this often that copies still wait for it [s]."""
MOST_NAMED = 64
"""A robot that is back is told the names of so many keys of which copies wait."""

EXPIRED, OVERFLOW, GONE = "dropped:expired", "dropped:overflow", "dropped:gone"
UNWANTED, ONCE, NO_SPEC = "dropped:unwanted", "dropped:once", "dropped:no-spec"
FORWARDED = "forwarded"


@dataclass(slots=True, eq=False)
class Copy:
    """A sample kept for the robot with the tag `to`, worth nothing after `until` [s]."""

    waiting: Waiting
    to: str
    until: float
    most: int
    """So many of its stream are kept for one robot."""
    delete: bool
    ready_at: float = -math.inf
    """When it is looked at again [s]."""


@dataclass(slots=True)
class _Sent:
    """A sample that was sent lately, when to whom, by tag, as a copy for any of them would be."""

    copy: Copy
    at: dict[str, float]


@dataclass(frozen=True, slots=True)
class Leaving:
    """A robot whose token has vanished. `reached` are keys of `once` of which it was sent a sample.

    A robot whose specs are `alike` ours notices what it has received already.
    """

    name: str
    tag: str
    subscriptions: tuple[str, ...]
    reached: frozenset[str]
    alike: bool


@dataclass(slots=True)
class _Away:
    """A robot that is kept for; it is `back` when its token is, and `known` when its subscriptions are, too."""

    robot: Leaving
    since: float
    back: bool = False
    known: bool = False
    copies: dict[str, list[Copy]] = field(default_factory=dict)
    """By key, the oldest first."""
    handing: dict[int, Copy] = field(default_factory=dict)
    """Those on their way to the mesh session, by sample."""
    named: frozenset[str] = frozenset()
    """The keys of which it knows that copies wait for it..."""
    named_at: float = -math.inf
    """... and when that was told last [s]."""

    def wants(self, key: str) -> bool:
        return any(intersects(expression, key) for expression in self.robot.subscriptions)

    def all(self) -> Iterator[Copy]:
        """Those that wait."""
        return (copy for copies in self.copies.values() for copy in copies)

    @property
    def count(self) -> int:
        return len(self.handing) + sum(map(len, self.copies.values()))

    @property
    def keys(self) -> frozenset[str]:
        """Those of which not all copies are handed over."""
        return frozenset(self.copies) | {copy.waiting.key for copy in self.handing.values()}


class Kept:
    """The copies, bounded, and what became of them: entered = waiting + handing + the sum of `by_reason`.

    A robot that is away for longer than `longest` [s] is gone; 0: nothing is kept.
    """

    def __init__(self, longest: float) -> None:
        self.longest = longest
        self.entered = 0
        self.by_reason: Counter[str] = Counter()
        self._away: dict[str, _Away] = {}
        self._open: dict[int, Copy] = {}
        """Samples of which each counts that are not sent and not dropped yet, as copies for nobody."""
        self._early: dict[int, set[str]] = {}
        """For whom copies of these are kept already, by tag."""
        self._sent: dict[str, dict[int, _Sent]] = {}
        """Samples sent lately, by key."""
        self._held: Counter[int] = Counter()
        """How many have an interest in the payload of a sample."""
        self._sizes: dict[int, int] = {}
        self._bytes = 0
        self._new: set[int] = set()
        self._freed: set[int] = set()
        """Samples that the driver is to keep from now on, and those that it may forget."""
        self._lost: dict[str, None] = {}
        """Robots that vanished, by tag, and are not back."""
        self._words = 0
        self._said: list[Command] = []
        """What robots that are back are told."""
        self._swept = -math.inf

    def __bool__(self) -> bool:
        return bool(self._away)

    @property
    def waiting(self) -> int:
        """Copies that wait, or are on their way to the mesh session."""
        return self.entered - self.by_reason.total()

    @property
    def conserved(self) -> bool:
        """Whether no copy is unaccounted for."""
        return self.waiting == sum(away.count for away in self._away.values())

    def subscriptions(self) -> set[str]:
        """Return what those that are away subscribe to."""
        return {expression for away in self._away.values() for expression in away.robot.subscriptions}

    def published(self, waiting: Waiting, lifetime: float, most: int, *, delete: bool) -> None:
        """A sample came of which each counts, for `lifetime` [s]: it is kept for each that is away and wants it."""
        if not self.longest:
            return
        until = waiting.t_gen + min(lifetime, self.longest)
        self._open[waiting.sample] = copy = Copy(waiting, "", until, most, delete)
        for away in self._away.values():
            if not away.known and waiting.key not in away.robot.reached and away.wants(waiting.key):
                self._keep(away, copy)
        self._bound()

    def follows(self, sample: int) -> bool:
        """Whether each sample counts of the stream of one that is not sent or dropped yet."""
        return sample in self._open

    def decided(self, now: float, sample: int, names: Collection[str], *, sent: bool) -> None:
        """A sample was sent to the robots with these tags, or there was no room for it; others do not get it.

        Who of them vanishes soon may not have got it. Where copies take the room, what they displace is one more.
        """
        copy, kept_for = self._open.pop(sample), self._early.pop(sample, set())
        for away in self._away.values() if not sent else ():
            if away.known and away.robot.tag in names and away.robot.tag not in kept_for:
                self._keep(away, copy)
        if at := dict.fromkeys((name for name in names if name), now):
            self._note(copy, at)
            self._bound()

    def refused(self, key: str, sample: int) -> None:
        """The mesh session did not take a sample that was forwarded: nobody got it, and nobody is to."""
        self._forget(key, sample)

    def lost(self, now: float, robot: Leaving) -> None:
        """A robot has vanished: what it may not have got is kept for it, and what comes from now on."""
        self._lost[robot.tag] = None
        if len(self._lost) > MOST_ROBOTS:
            del self._lost[next(iter(self._lost))]
        if not self.longest:
            return
        away = self._away.pop(robot.tag, None)
        if away is None:
            self._make_place()
            away = _Away(robot, now)
        elif away.known:
            away.robot, away.since = robot, now
        away.back, away.known, away.named = False, False, frozenset()
        self._away[robot.tag] = away
        held = {copy.waiting.sample for copy in away.all()} | away.handing.keys()
        doubtful = [sent.copy for sent in self._doubtful(now, robot)]
        for copy in (*doubtful, *self._open.values()):
            wanted = away.wants(copy.waiting.key) and copy.waiting.sample not in held
            if wanted and (copy in doubtful or copy.waiting.key not in robot.reached):
                self._keep(away, copy)
        for copy in away.handing.values():  # whether they arrive is not known: they are offered again
            away.copies.setdefault(copy.waiting.key, []).append(copy)
        away.handing = {}
        for copies in away.copies.values():
            copies.sort(key=_age)
        self._bound()

    def appeared(self, name: str, tag: str) -> None:
        """A robot has appeared: what was kept can go, but another session of the same name is gone for good."""
        if (known := self._away.get(tag)) is not None:
            known.back = True
        else:
            for away in [away for away in self._away.values() if away.robot.name == name]:
                self._leave(away)

    def reached(self, tag: str) -> frozenset[str]:
        """Return the keys of `once` of which a robot that is back has a sample for certain."""
        away = self._away.get(tag)
        return frozenset() if away is None else away.robot.reached - away.copies.keys()

    def told(self, tag: str, subscriptions: Iterable[str]) -> None:
        """A robot that is back subscribes to this: all else is not wanted any more, and new samples reach it.

        It waits to be told whether anything is kept for it.
        """
        waits = tag in self._lost
        self._lost.pop(tag, None)
        away = self._away.get(tag)
        if away is None:
            if waits:
                self._say(tag, frozenset(), grows=True)
            return
        wanted = tuple(subscriptions)
        for copy in [c for c in away.all() if not any(intersects(each, c.waiting.key) for each in wanted)]:
            self.give_up(copy, UNWANTED)
        away.known = True
        if waits:
            away.named = away.keys
            self._say(tag, away.keys, grows=True)
        self._done(tag)

    def foremost(self, now: float) -> Copy | None:
        """Return the copy that is next: of the highest priority, then the oldest, of a robot that is back."""
        if not self._away:
            return None
        first = (copies[0] for away in self._away.values() if away.back for copies in away.copies.values() if copies)
        return min((c for c in first if c.ready_at <= now), key=lambda c: (c.waiting.priority, *_age(c)), default=None)

    def waits(self, copy: Copy) -> bool:
        """Whether a copy waits still, for a robot that is back."""
        away = self._away.get(copy.to)
        return away is not None and away.back and any(c is copy for c in away.copies.get(copy.waiting.key, ()))

    def next_at(self, now: float) -> float:
        """When copies that could not be sent are to be looked at again [s], if nothing happens before."""
        return now + LOOK if any(away.back and away.copies for away in self._away.values()) else math.inf

    def postpone(self, now: float, copy: Copy) -> None:
        """A copy is not sent now; those of its stream that are younger wait for it."""
        copy.ready_at = now + RETRY

    def hand(self, copy: Copy) -> None:
        """A copy is on its way to the mesh session."""
        away = self._away[copy.to]
        self._take_out(away, copy)
        away.handing[copy.waiting.sample] = copy

    def handed(self, now: float, sample: int, to: str) -> None:
        """The mesh session took a copy; should the robot vanish again soon, it is offered once more."""
        copy = self._handing(sample, to)
        if copy is not None:
            self.by_reason[FORWARDED] += 1
            self._done(to)
            self._note(copy, {to: now})
            self._release(sample)
            self._bound()

    def turned_back(self, now: float, sample: int, to: str) -> None:
        """The mesh session did not take a copy: it goes on waiting."""
        copy = self._handing(sample, to)
        if copy is not None:
            self.postpone(now, copy)
            self._away[to].copies.setdefault(copy.waiting.key, []).insert(0, copy)

    def give_up(self, copy: Copy, reason: str) -> None:
        """Keep a copy no longer."""
        self._take_out(self._away[copy.to], copy)
        self.by_reason[reason] += 1
        self._done(copy.to)
        self._release(copy.waiting.sample)

    def sweep(self, now: float) -> bool:
        """Forget what is too old, and who has been away for too long; whether anybody is gone. Cheap at every event."""
        if now < self._swept + RETRY or not (self._away or self._sent):
            return False
        self._swept = now
        for away in list(self._away.values()):
            for copy in [copy for copy in away.all() if copy.until <= now]:
                self.give_up(copy, EXPIRED)
            if away.named and now >= away.named_at + AGAIN:
                away.named_at = now
                self._say(away.robot.tag, away.named, grows=True)
        gone = [away for away in self._away.values() if not away.back and now >= away.since + self.longest]
        for away in gone:
            self._leave(away)
        old = [(k, n) for k, many in self._sent.items() for n, s in many.items() if max(s.at.values()) < now - DOUBT]
        for key, sample in old:
            self._forget(key, sample)
        return bool(gone)

    def around(self, commands: list[Command]) -> list[Command]:
        """Return commands with what the driver has to keep before them, and what it may forget after them."""
        if self._new or self._freed:
            keep, forget = map(Keep, sorted(self._new)), map(Forget, sorted(self._freed))
            commands = [*keep, *commands, *forget]
            self._new, self._freed = set(), set()
        for away in self._away.values():
            if away.known and (keys := away.keys) != away.named:
                self._name(away, keys)
        said, self._said = self._said, []
        return [*commands, *said]

    def described(self, now: float) -> dict[str, Any]:
        """Return what the status says: the copies, and who is away."""
        return {
            "in": self.entered,
            "waiting": self.waiting,
            "bytes": self._bytes,
            "conserved": self.conserved,
            "by_reason": dict(sorted(self.by_reason.items())),
            "for": [
                {
                    "robot": away.robot.name,
                    "back": away.back,
                    "away": now - away.since,
                    "samples": away.count,
                }
                for away in self._away.values()
            ],
        }

    def _keep(self, away: _Away, like: Copy) -> None:
        """Keep a copy for a robot; of too many of a stream the least valuable leaves."""
        waiting = like.waiting
        copy = Copy(waiting, away.robot.tag, like.until, like.most, like.delete)
        copies = away.copies.setdefault(waiting.key, [])
        copies.append(copy)
        self.entered += 1
        self._hold(waiting)
        if waiting.sample in self._open:
            self._early.setdefault(waiting.sample, set()).add(away.robot.tag)
        if len(copies) > copy.most:
            self.give_up(min(copies, key=_value), OVERFLOW)

    def _doubtful(self, now: float, robot: Leaving) -> list[_Sent]:
        """What was sent to a robot lately."""
        if not robot.alike:
            return []
        sent = (each for many in self._sent.values() for each in many.values())
        return [each for each in sent if each.at.get(robot.tag, -math.inf) >= now - DOUBT]

    def _note(self, copy: Copy, at: Mapping[str, float]) -> None:
        """A sample was sent just now; of a stream as many are remembered as are kept."""
        waiting = copy.waiting
        many = self._sent.setdefault(waiting.key, {})
        known = many.pop(waiting.sample, None)
        many[waiting.sample] = _Sent(copy, {**(known.at if known is not None else {}), **at})
        if known is None:
            self._hold(waiting)
        if len(many) > copy.most:
            self._forget(waiting.key, next(iter(many)))

    def _forget(self, key: str, sample: int) -> None:
        """A sample was sent long ago."""
        many = self._sent.get(key, {})
        if many.pop(sample, None) is not None:
            if not many:
                del self._sent[key]
            self._release(sample)

    def _hold(self, waiting: Waiting) -> None:
        sample = waiting.sample
        self._held[sample] += 1
        if self._held[sample] == 1:
            self._sizes[sample] = waiting.size
            self._bytes += waiting.size
            (self._freed.discard if sample in self._freed else self._new.add)(sample)

    def _release(self, sample: int) -> None:
        self._held[sample] -= 1
        if not self._held[sample]:
            del self._held[sample]
            self._bytes -= self._sizes.pop(sample)
            (self._new.discard if sample in self._new else self._freed.add)(sample)

    def _bound(self) -> None:
        """Forget until there is room for the rest: first what was sent, then the copies that are worth least."""
        while self._bytes > MOST_BYTES and self._sent:
            key, many = next(iter(self._sent.items()))
            self._forget(key, next(iter(many)))
        while self._bytes > MOST_BYTES or self.waiting > MOST_COPIES:
            copies = [copy for away in self._away.values() for copy in away.all()]
            if not copies:
                break
            self.give_up(min(copies, key=lambda c: (c.waiting.worth, *_age(c))), OVERFLOW)

    def _make_place(self) -> None:
        if len(self._away) >= MOST_ROBOTS:
            self._leave(next(iter(self._away.values())))

    def _leave(self, away: _Away) -> None:
        """A robot is gone for good."""
        for copy in (*away.all(), *away.handing.values()):
            self.by_reason[GONE] += 1
            self._release(copy.waiting.sample)
        del self._away[away.robot.tag]

    def _handing(self, sample: int, to: str) -> Copy | None:
        away = self._away.get(to)
        return None if away is None else away.handing.pop(sample, None)

    def _take_out(self, away: _Away, copy: Copy) -> None:
        copies = away.copies[copy.waiting.key]
        copies.remove(copy)
        if not copies:
            del away.copies[copy.waiting.key]

    def _done(self, tag: str) -> None:
        """Look whether a robot that is back has got all: then it is one as any other."""
        away = self._away.get(tag)
        if away is not None and away.known and not away.copies and not away.handing:
            if away.named:
                self._name(away, frozenset())
            del self._away[tag]

    def _name(self, away: _Away, keys: frozenset[str]) -> None:
        """Tell a robot that is back for which keys copies wait now."""
        grows = not keys <= away.named
        away.named = keys
        self._say(away.robot.tag, keys, grows=grows)

    def _say(self, tag: str, keys: frozenset[str], *, grows: bool) -> None:
        self._words += 1
        named = tuple(sorted(keys)) if len(keys) <= MOST_NAMED else None
        self._said.append(TellBacklog(tag, self._words, named, grows))


def _age(copy: Copy) -> tuple[float, int]:
    return copy.waiting.t_gen, copy.waiting.sample


def _value(copy: Copy) -> tuple[bool, float, float, int]:
    """Order those of one stream by what they are worth; a deletion stays."""
    return copy.delete, copy.waiting.scale, *_age(copy)
