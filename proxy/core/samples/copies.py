"""The copies of all robots that are away, bounded, and what became of them."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping

from proxy.core.interface.commands import Command, Forget, Keep, TellBacklog
from proxy.core.model.waiting import Waiting
from proxy.core.protocol.checked import is_key
from proxy.core.samples.away import Away, Copy, Leaving
from proxy.core.samples.tuning import TUNING


class HeldPayloads:
    """Counts who needs the payload of a sample."""

    def __init__(self) -> None:
        self.bytes = 0
        """What all payloads take that are kept [B]."""
        self._holders: Counter[int] = Counter()
        self._sizes: dict[int, int] = {}
        self._new: set[int] = set()
        self._freed: set[int] = set()
        """Samples that the driver is to keep from now on, and those that it may forget."""

    def hold(self, waiting: Waiting) -> None:
        """One more needs the payload of a sample."""
        sample = waiting.sample
        self._holders[sample] += 1
        if self._holders[sample] == 1:
            self._sizes[sample] = waiting.size
            self.bytes += waiting.size
            (self._freed.discard if sample in self._freed else self._new.add)(sample)

    def release(self, sample: int) -> None:
        """One less needs the payload of a sample."""
        self._holders[sample] -= 1
        if not self._holders[sample]:
            del self._holders[sample]
            self.bytes -= self._sizes.pop(sample)
            (self._new.discard if sample in self._new else self._freed.add)(sample)

    def around(self, commands: list[Command]) -> list[Command]:
        """Return commands with what the driver has to keep before them, and what it may forget after them."""
        if not (self._new or self._freed):
            return commands
        keep, forget = map(Keep, sorted(self._new)), map(Forget, sorted(self._freed))
        self._new, self._freed = set(), set()
        return [*keep, *commands, *forget]


class SentLately:
    """Of each key as many as are kept for one robot."""

    def __init__(self, payloads: HeldPayloads) -> None:
        self._payloads = payloads
        self._sent: dict[str, dict[int, tuple[Copy, Mapping[str, float]]]] = {}
        """By key and sample: a copy of it for anybody, and by tag when it was sent to which robots [s]."""

    def __bool__(self) -> bool:
        return bool(self._sent)

    def note(self, copy: Copy, at: Mapping[str, float]) -> None:
        """A sample was sent at these times to these robots."""
        waiting = copy.waiting
        many = self._sent.setdefault(waiting.key, {})
        if waiting.sample not in many:
            self._payloads.hold(waiting)
        _, before = many.pop(waiting.sample, (copy, {}))
        many[waiting.sample] = copy, {**before, **at}
        if len(many) > copy.most:
            self.forget(waiting.key, next(iter(many)))

    def doubtful(self, now: float, robot: Leaving) -> list[Copy]:
        """Return what a robot that vanishes now may not have got; nothing if it would not notice what it has."""
        if not robot.alike:
            return []
        since, sent = now - TUNING.doubtful, (each for many in self._sent.values() for each in many.values())
        return [copy for copy, at in sent if at.get(robot.tag, -math.inf) >= since]

    def forget(self, key: str, sample: int) -> None:
        """Nobody needs a sample any more."""
        many = self._sent.get(key, {})
        if many.pop(sample, None) is not None:
            if not many:
                del self._sent[key]
            self._payloads.release(sample)

    def forget_oldest(self) -> None:
        """There is no room for all: one leaves."""
        key, many = next(iter(self._sent.items()))
        self.forget(key, next(iter(many)))

    def sweep(self, now: float) -> None:
        """Forget what has arrived for certain."""
        since = now - TUNING.doubtful
        old = [(k, n) for k, many in self._sent.items() for n, (_, at) in many.items() if max(at.values()) < since]
        for key, sample in old:
            self.forget(key, sample)


OVERFLOW, GONE, FORWARDED = "dropped:overflow", "dropped:gone", "forwarded"


class Copies:
    """All copies are accounted for: entered = waiting + on their way to the mesh session + the sum of `by_reason`."""

    def __init__(self) -> None:
        self.payloads = HeldPayloads()
        self.sent = SentLately(self.payloads)
        self.entered = 0
        self.by_reason: Counter[str] = Counter()
        self._away: dict[str, Away] = {}
        self._announced, self._announcements = 0, list[Command]()

    def __bool__(self) -> bool:
        return bool(self._away)

    def __iter__(self) -> Iterator[Away]:
        return iter(list(self._away.values()))

    def of(self, tag: str) -> Away | None:
        """Return the robot with this tag, if anything is kept for it."""
        return self._away.get(tag)

    @property
    def waiting(self) -> int:
        """Copies that wait, or are on their way to the mesh session."""
        return self.entered - self.by_reason.total()

    @property
    def conserved(self) -> bool:
        """Whether no copy is unaccounted for."""
        return self.waiting == sum(away.count for away in self)

    def lose(self, now: float, robot: Leaving) -> Away:
        """A robot has vanished. Where that is one robot too many, the one that vanished first is given up."""
        away = self._away.pop(robot.tag, None)
        if away is None:
            if len(self._away) >= TUNING.robots:
                self.leave(next(iter(self._away.values())))
            away = Away(now, robot)
        else:
            away.vanish(now, robot)
        self._away[robot.tag] = away
        return away

    def keep(self, away: Away, like: Copy) -> None:
        """Keep a copy for a robot. Where that is one too many of its stream, the least valuable copy leaves."""
        copy = Copy(like.waiting, away.robot.tag, like.until, like.most, like.delete)
        self.entered += 1
        self.payloads.hold(copy.waiting)
        if (least := away.add(copy)) is not None:
            self.give_up(least, OVERFLOW)

    def waits(self, copy: Copy) -> bool:
        """Whether a copy waits still, for a robot that is back."""
        away = self._away.get(copy.to)
        return away is not None and away.back and away.has(copy)

    def next_at(self, now: float) -> float:
        """When copies that could not be sent are to be looked at again [s], if nothing happens before."""
        waits = any(away.back and any(away.waiting()) for away in self._away.values())
        return now + TUNING.room_checked_every if waits else math.inf

    def hand(self, copy: Copy) -> None:
        """A copy is on its way to the mesh session."""
        self._away[copy.to].hand(copy)

    def handed(self, now: float, sample: int, to: str) -> None:
        """The mesh session took a copy; should the robot vanish again soon, it is offered once more."""
        away = self._away.get(to)
        if away is not None and (copy := away.answer(sample)) is not None:
            self.by_reason[FORWARDED] += 1
            self.finish(away)
            self.sent.note(copy, {to: now})
            self.payloads.release(sample)
            self.bound()

    def turned_back(self, now: float, sample: int, to: str) -> None:
        """The mesh session did not take a copy: it goes on waiting."""
        away = self._away.get(to)
        if away is not None and (copy := away.answer(sample)) is not None:
            copy.postpone(now + TUNING.retry)
            away.turn_back(copy)

    def give_up(self, copy: Copy, reason: str) -> None:
        """Keep a copy no longer."""
        away = self._away[copy.to]
        away.remove(copy)
        self.by_reason[reason] += 1
        self.finish(away)
        self.payloads.release(copy.waiting.sample)

    def leave(self, away: Away) -> None:
        """A robot is gone for good."""
        for copy in away.all():
            self.by_reason[GONE] += 1
            self.payloads.release(copy.waiting.sample)
        del self._away[away.robot.tag]

    def finish(self, away: Away) -> None:
        """A robot that is back has got all its copies: nothing is known of it here any more."""
        if away.known and not away.count and self.of(away.robot.tag) is away:
            self.announce_news(away)
            del self._away[away.robot.tag]

    def announce(self, to: str, keys: frozenset[str], *, grows: bool = True) -> None:
        """Announce to a robot that is back of which keys copies wait for it, all or none of them new to it."""
        self._announced += 1
        if (away := self._away.get(to)) is not None:
            away.tell(keys)
        nameable = len(keys) <= TUNING.named_keys and all(map(is_key, keys))
        named = tuple(sorted(keys)) if nameable else None
        self._announcements.append(TellBacklog(to, self._announced, named, grows))

    def announce_news(self, away: Away) -> None:
        """Announce to a robot what is news of what waits for it."""
        if (keys := away.keys) != away.named:
            self.announce(away.robot.tag, keys, grows=not keys <= away.named)

    def take_announcements(self) -> list[Command]:
        """Return what is to be announced since the last call."""
        announcements, self._announcements = self._announcements, []
        return announcements

    def bound(self) -> None:
        """Make room: forget first what was sent lately, then the copies that are worth least."""
        while self.payloads.bytes > TUNING.payload_bytes and self.sent:
            self.sent.forget_oldest()
        while self.payloads.bytes > TUNING.payload_bytes or self.waiting > TUNING.copies:
            copies = [copy for away in self for copy in away.waiting()]
            if not copies:
                break
            self.give_up(min(copies, key=lambda c: (c.waiting.worth, *c.age_order)), OVERFLOW)
