"""Announcements to robots that are back: the keys of which copies wait for them."""

import math

from proxy.core.interface.commands import Command, TellBacklog
from proxy.core.samples.tuning import TUNING


class BacklogAnnouncements:
    """What each robot was announced last, by tag."""

    def __init__(self) -> None:
        self._number = 0
        self._commands: list[Command] = []
        self._named: dict[str, frozenset[str]] = {}
        """The keys of which a robot knows that copies wait for it."""
        self._reminded_at: dict[str, float] = {}

    def answer(self, to: str, keys: frozenset[str]) -> None:
        """A robot waits to hear whether anything is kept for it."""
        self._announce(to, keys, grows=True)

    def update(self, to: str, keys: frozenset[str]) -> None:
        """Copies of these keys wait for a robot now: it is announced what is news."""
        named = self._named.get(to, frozenset())
        if keys != named:
            self._announce(to, keys, grows=not keys <= named)

    def repeat(self, now: float, to: str) -> None:
        """Remind a robot from time to time of what waits."""
        named = self._named.get(to)
        if named and now >= self._reminded_at.get(to, -math.inf) + TUNING.reminder_every:
            self._reminded_at[to] = now
            self._announce(to, named, grows=True)

    def vanish(self, to: str) -> None:
        """A robot that vanishes forgets what was announced."""
        self._named.pop(to, None)

    def forget(self, to: str) -> None:
        """Nothing is kept for a robot any more."""
        self._named.pop(to, None)
        self._reminded_at.pop(to, None)

    def take(self) -> list[Command]:
        """Return what is to be announced since the last call."""
        commands, self._commands = self._commands, []
        return commands

    def _announce(self, to: str, keys: frozenset[str], *, grows: bool) -> None:
        self._number += 1
        if keys:
            self._named[to] = keys
        else:
            self._named.pop(to, None)
        named = tuple(sorted(keys)) if len(keys) <= TUNING.named_keys else None
        self._commands.append(TellBacklog(to, self._number, named, grows))
