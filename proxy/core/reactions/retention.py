"""What is taken from applications, and noted of samples, for robots that vanish: each sample that counts is kept."""

from collections.abc import Iterable

from proxy.core.interface.commands import Command, Drop, Forward, Retain
from proxy.core.model.mode import Mode
from proxy.core.parts import Parts
from proxy.core.samples.gate import CONSTRAINT
from proxy.core.view.subscribers import common


class Retention:
    """`retained`: what applications publish on these is taken from them even if nobody who is here wants it."""

    def __init__(self, parts: Parts) -> None:
        self._parts = parts
        self.retained: frozenset[str] = frozenset()

    def renew(self) -> list[Command]:
        """Say what is to be taken whoever is here: so nothing is missed of whoever vanishes."""
        if not self._parts.settings.away:
            return []
        kinds = [each for each in self._parts.view.specs.types if each.planned and not each.markovian]
        wanted = self._parts.kept.subscriptions().union(
            *(peer.state.subscriptions for peer in self._parts.view.peers.values())
        )
        passes = self._parts.gate.appraisal.mode is Mode.PASS
        keys = set[str]() if passes else {key for each in kinds for key in each.keys}
        retained = frozenset(common(wanted, keys))
        if retained == self.retained:
            return []
        self.retained = retained
        return [Retain(tuple(sorted(retained)))]

    def sweep(self, now: float) -> list[Command]:
        """Forget who has been away for too long."""
        return self.renew() if self._parts.kept.sweep(now) else []

    def follow(self, now: float, commands: Iterable[Command]) -> None:
        """Note what becomes of samples: who vanishes soon may not have got them, or be why there was no room."""
        for command in commands:
            if isinstance(command, Forward | Drop) and (key := self._parts.kept.key_of(command.sample)) is not None:
                lost = isinstance(command, Drop) and command.reason != CONSTRAINT
                names = () if lost else self._wanting(key)
                self._parts.kept.decided(now, command.sample, names, sent=isinstance(command, Forward))

    def _wanting(self, key: str) -> tuple[str, ...]:
        """Return the tags of those that want a sample of ours."""
        stream = self._parts.view.streams.known(self._parts.settings.robot, key)
        return () if stream is None else self._parts.view.subscribers.of(stream)
