"""The copies of all robots that are away, bounded, and what became of them."""

import math
from collections import Counter
from collections.abc import Iterator
from typing import Any

from proxy.core.samples.away import Away, Copy, Leaving
from proxy.core.samples.backlog_announcements import BacklogAnnouncements
from proxy.core.samples.held_payloads import HeldPayloads
from proxy.core.samples.sent_lately import SentLately
from proxy.core.samples.tuning import TUNING

OVERFLOW, GONE, FORWARDED = "dropped:overflow", "dropped:gone", "forwarded"


class Copies:
    """All copies are accounted for: entered = waiting + on their way to the mesh session + the sum of `by_reason`."""

    def __init__(self) -> None:
        self.payloads = HeldPayloads()
        self.sent = SentLately(self.payloads)
        self.announcements = BacklogAnnouncements()
        self.entered = 0
        self.by_reason: Counter[str] = Counter()
        self._away: dict[str, Away] = {}

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
            self.announcements.vanish(robot.tag)
        self._away[robot.tag] = away
        return away

    def keep(self, away: Away, like: Copy) -> None:
        """Keep a copy for a robot. Where that is one too many of its stream, the least valuable copy leaves."""
        copy = Copy(like.waiting, away.robot.tag, like.until, like.most, like.delete)
        self.entered += 1
        self.payloads.hold(copy.waiting)
        if (least := away.add(copy)) is not None:
            self.give_up(least, OVERFLOW)

    def foremost(self, now: float) -> Copy | None:
        """Return the copy that is next: of the highest priority, then the oldest, of a robot that is back."""
        first = (copy for away in self._away.values() if away.back for copy in away.oldest() if copy.ready_at <= now)
        return min(first, key=lambda c: (c.waiting.priority, *c.age_order), default=None)

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
        self._forget(away)

    def finish(self, away: Away) -> None:
        """A robot that is back has got all its copies: nothing is known of it here any more."""
        if away.known and not away.count and self.of(away.robot.tag) is away:
            self.announcements.update(away.robot.tag, frozenset())
            self._forget(away)

    def bound(self) -> None:
        """Make room: forget first what was sent lately, then the copies that are worth least."""
        while self.payloads.bytes > TUNING.payload_bytes and self.sent:
            self.sent.forget_oldest()
        while self.payloads.bytes > TUNING.payload_bytes or self.waiting > TUNING.copies:
            copies = [copy for away in self for copy in away.waiting()]
            if not copies:
                break
            self.give_up(min(copies, key=lambda c: (c.waiting.worth, *c.age_order)), OVERFLOW)

    def described(self, now: float) -> dict[str, Any]:
        """Return what the status says: the copies, and who is away."""
        return {
            "in": self.entered,
            "waiting": self.waiting,
            "bytes": self.payloads.bytes,
            "conserved": self.conserved,
            "by_reason": dict(sorted(self.by_reason.items())),
            "for": [
                {"robot": away.robot.name, "back": away.back, "away": now - away.since, "samples": away.count}
                for away in self
            ],
        }

    def _forget(self, away: Away) -> None:
        del self._away[away.robot.tag]
        self.announcements.forget(away.robot.tag)
