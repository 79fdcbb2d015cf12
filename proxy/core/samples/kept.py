"""Copies for robots that are away, of samples of which each counts, until their robot is back or gone.

A presence token vanishes late, so what was sent shortly before is offered again, and the robot leaves out what it has.

Who is back has each copy decided like any other sample, the older ones first. Payloads are with the driver.
"""

import math
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field

from proxy.core.interface.commands import Command
from proxy.core.model.waiting import Waiting
from proxy.core.samples.away import Copy, Leaving
from proxy.core.samples.copies import Copies
from proxy.core.samples.tuning import TUNING
from proxy.core.view.subscribers import intersects

EXPIRED, UNWANTED = "dropped:expired", "dropped:unwanted"


@dataclass(frozen=True, slots=True)
class _Undecided:
    """A sample that is neither sent nor dropped yet, as a copy for nobody, and the robots that have copies already."""

    copy: Copy
    kept_for: set[str] = field(default_factory=set)


class Kept:
    """Keeps copies as robots vanish, return or are gone, after `longest` [s] (0: none), and as samples are decided."""

    def __init__(self, longest: float) -> None:
        self.longest = longest
        self.copies = Copies()
        self._undecided: dict[int, _Undecided] = {}
        self._lost: dict[str, None] = {}
        """Robots that vanished, by tag, and are not back."""
        self._swept = -math.inf

    def subscriptions(self) -> set[str]:
        """Return what those that are away subscribe to."""
        return {expression for away in self.copies for expression in away.robot.subscriptions}

    def published(self, waiting: Waiting, lifetime: float, most: int, *, delete: bool) -> None:
        """A sample came of a stream of which each counts: for `lifetime` [s] it is kept for those away that want it."""
        if not self.longest:
            return
        until = waiting.t_gen + min(lifetime, self.longest)
        self._undecided[waiting.sample] = each = _Undecided(Copy(waiting, "", until, most, delete))
        for away in self.copies:
            if not away.known and waiting.key not in away.robot.reached and away.wants(waiting.key):
                self.copies.keep(away, each.copy)
                each.kept_for.add(away.robot.tag)
        self.copies.bound()

    def key_of(self, sample: int) -> str | None:
        """Return the key of a sample that is not sent or dropped yet, if each sample of it counts."""
        each = self._undecided.get(sample)
        return None if each is None else each.copy.waiting.key

    def decided(self, now: float, sample: int, names: Collection[str], *, sent: bool) -> None:
        """A sample was sent to the robots with these tags, or had no room: then it is kept for who is back."""
        each = self._undecided.pop(sample)
        for away in self.copies if not sent else ():
            if away.known and away.robot.tag in names and away.robot.tag not in each.kept_for:
                self.copies.keep(away, each.copy)
        if at := dict.fromkeys((name for name in names if name), now):
            self.copies.sent.note(each.copy, at)
            self.copies.bound()

    def refused(self, key: str, sample: int) -> None:
        """A sample was forwarded, and the mesh session did not take it, or it is gone undecided: nobody gets it."""
        self._undecided.pop(sample, None)
        self.copies.sent.forget(key, sample)

    def lost(self, now: float, robot: Leaving) -> None:
        """A robot has vanished: what it may not have got is kept for it, and what comes from now on."""
        self._lost[robot.tag] = None
        if len(self._lost) > TUNING.robots:
            del self._lost[next(iter(self._lost))]
        if not self.longest:
            return
        away = self.copies.lose(now, robot)
        held = {copy.waiting.sample for copy in away.all()}
        for copy in self.copies.sent.doubtful(now, robot):
            if away.wants(copy.waiting.key) and copy.waiting.sample not in held:
                self.copies.keep(away, copy)
        for sample, each in self._undecided.items():
            key = each.copy.waiting.key
            if away.wants(key) and sample not in held and key not in robot.reached:
                self.copies.keep(away, each.copy)
                each.kept_for.add(robot.tag)
        away.offer_again()
        self.copies.bound()

    def appeared(self, name: str, tag: str) -> None:
        """A robot has appeared: what was kept can go, but another session of the same name is gone for good."""
        if (known := self.copies.of(tag)) is not None:
            known.appear()
            return
        for away in self.copies:
            if away.robot.name == name:
                self.copies.leave(away)

    def reached(self, tag: str) -> frozenset[str]:
        """Return the keys of `once` of which a robot that is back has a sample for certain."""
        away = self.copies.of(tag)
        return frozenset() if away is None else away.reached

    def subscribed(self, tag: str, subscriptions: Iterable[str]) -> None:
        """A robot that is back subscribes to this: all else is not wanted any more, and new samples reach it."""
        waits, away = tag in self._lost, self.copies.of(tag)
        self._lost.pop(tag, None)
        if away is None:
            if waits:
                self.copies.announce(tag, frozenset())
            return
        wanted = tuple(subscriptions)
        for copy in list(away.waiting()):
            if not any(intersects(each, copy.waiting.key) for each in wanted):
                self.copies.give_up(copy, UNWANTED)
        away.subscribe()
        if waits:
            self.copies.announce(tag, away.keys)
        self.copies.finish(away)

    def sweep(self, now: float) -> bool:
        """Forget what is too old, and who has been away for too long; whether anybody is gone. Cheap at every event."""
        if now < self._swept + TUNING.retry or not (self.copies or self.copies.sent):
            return False
        self._swept = now
        for away in self.copies:
            for copy in [copy for copy in away.waiting() if copy.until <= now]:
                self.copies.give_up(copy, EXPIRED)
            if away.reminds(now):
                self.copies.announce(away.robot.tag, away.named)
        gone = [away for away in self.copies if not away.back and now >= away.since + self.longest]
        for away in gone:
            self.copies.leave(away)
        self.copies.sent.sweep(now)
        return bool(gone)

    def around(self, commands: list[Command]) -> list[Command]:
        """Return commands with what the driver has to keep and may forget, and what robots are announced."""
        commands = self.copies.payloads.around(commands)
        for away in self.copies:
            if away.known:
                self.copies.announce_news(away)
        return [*commands, *self.copies.take_announcements()]
