"""The samples of ours that are undecided: those that wait, those that are read again, and the one being decided.

Deletions of a key pass between its samples. Of a Markovian stream the newest sample, or deletion, wins.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import chain

from proxy.core.interface.commands import Command, Reread
from proxy.core.model.settings import CoreSettings
from proxy.core.model.waiting import Waiting
from proxy.core.samples.inbox import SUPERSEDED, Evicted, Inbox
from proxy.core.samples.outcomes import Outcomes
from proxy.core.samples.search import Search


@dataclass(frozen=True, slots=True)
class _Deletion:
    """A deletion of a key, and the undecided samples of it that go first."""

    sample: int
    key: str
    behind: frozenset[int]


class Deletions:
    """The deletions that wait, in the order in which they came."""

    def __init__(self) -> None:
        self._waiting: list[_Deletion] = []

    def add(self, sample: int, key: str, undecided: Iterable[Waiting]) -> None:
        """A deletion came; it waits for those of the undecided samples that are of its key."""
        self._waiting.append(_Deletion(sample, key, frozenset(w.sample for w in undecided if w.key == key)))

    def holds(self, waiting: Waiting) -> bool:
        """Whether a sample came after a deletion of its key that did not pass yet."""
        return any(d.key == waiting.key and waiting.sample not in d.behind for d in self._waiting)

    def due(self, undecided: Iterable[Waiting]) -> list[int]:
        """Remove and return the deletions that have nothing before them any more."""
        if not self._waiting:
            return []
        still = {w.sample for w in undecided}
        passing = [d for d in self._waiting if d.behind.isdisjoint(still)]
        self._waiting = [d for d in self._waiting if not d.behind.isdisjoint(still)]
        return [d.sample for d in passing]


class Undecided:
    """Holds all that is undecided, in order."""

    def __init__(self, settings: CoreSettings, search: Search, outcomes: Outcomes) -> None:
        self.inbox = Inbox(settings.inbox, settings.backlog, settings.inbox_bytes)
        self._search = search
        self._outcomes = outcomes
        self._deletions = Deletions()
        self._unsettled: dict[int, Waiting] = {}
        """Samples whose worth by the specs in force is not known yet."""

    def __iter__(self) -> Iterator[Waiting]:
        return chain(self.inbox, self._unsettled.values(), self._search.deciding())

    @property
    def wait(self) -> bool:
        """Whether samples wait, to be taken up or to be read again."""
        return bool(self.inbox) or bool(self._unsettled)

    def holds(self, key: str) -> bool:
        """Whether a sample of a key is undecided."""
        return any(each.key == key for each in self)

    def put(self, now: float, waiting: Waiting) -> list[Command]:
        """Queue a sample; drop what has to leave for it."""
        return [*self._outcomes.evict(now, self.inbox.put(waiting)), *self.pass_deletions()]

    def take(self, held: Callable[[Waiting], bool] = lambda _: False) -> Waiting | None:
        """Remove and return the next sample to decide, but none that is `held` or comes after a deletion."""
        return self.inbox.take(lambda waiting: self._deletions.holds(waiting) or held(waiting))

    def take_all(self) -> Iterator[Waiting]:
        """Remove and return the sample being decided, and then all that waits, as deletions pass."""
        yield from self._search.cancel()
        self.inbox.wake(math.inf)
        while (sample := self.take()) is not None:
            yield sample

    def unsettle(self) -> list[Command]:
        """Take back all that is undecided: specs changed, and no decision may mix old and new ones."""
        taken = [*self._search.cancel(), *self.inbox.clear()]
        self._unsettled |= {waiting.sample: waiting for waiting in taken}
        return [Reread(each.sample, each.key) for each in self._unsettled.values()]

    def settled(self, sample: int) -> Waiting | None:
        """Return a sample that was taken back, for it to be `put` again; None when it has left meanwhile."""
        return self._unsettled.pop(sample, None)

    def settle_all(self) -> None:
        """Queue all that was taken back as it is."""
        self.inbox.put_back(self._unsettled.values())
        self._unsettled.clear()

    def supersede(self, now: float, waiting: Waiting) -> list[Command] | None:
        """Drop a sample that was taken back if a newer one of its Markovian stream came meanwhile; else None."""
        newer = any(each.key == waiting.key and each.t_gen > waiting.t_gen for each in self)
        if not (newer and waiting.markovian):
            return None
        evicted = Evicted(waiting.sample, SUPERSEDED, waiting.key)
        return [*self._outcomes.evict(now, [evicted]), *self.pass_deletions()]

    def delete(self, now: float, key: str, sample: int) -> list[Command]:
        """A deletion of the key passes, behind what was published before it and is still undecided."""
        commands = self._outcomes.evict(now, self.inbox.supersede(key))
        self._deletions.add(sample, key, self)
        return [*commands, *self.pass_deletions()]

    def pass_deletions(self) -> list[Command]:
        """Pass the deletions that have nothing before them any more."""
        return [self._outcomes.pass_on(sample, "passed:delete") for sample in self._deletions.due(self)]
