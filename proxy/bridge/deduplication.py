"""Each sample and each query once, though several of our declarations match it.

Zenoh calls every matching subscriber and queryable of a session, one after the other on one thread, so a sample for
`a/b` comes twice where both `a/*` and `a/b` are declared. The first call takes it. Zenoh does not say which sample a
call is for: the calls of one round are for one, and a call belongs to it that is on the same thread, for the same key,
of a declaration that the round still lacks, and with the same contents.
"""

import itertools
import threading
from collections.abc import Callable, Hashable
from functools import partial
from typing import Any, Generic, TypeVar

import zenoh

from proxy.bridge.bounds import BOUNDS
from proxy.bridge.declaration import Declaration

T = TypeVar("T")

Handler = Any
"""A handler of Zenoh's, whose interface leaves out its type."""


class _Round:
    """The calls for one sample or query: the first one, and who may still be called for it."""

    __slots__ = ("contents", "doubtful", "key", "left")

    def __init__(self, key: str, left: set[int], doubtful: set[int], contents: tuple[object, ...]) -> None:
        self.key = key
        self.left = left
        self.doubtful = doubtful
        """Who was only being declared: they are called for it or not, so whose call one of theirs is stays unknown as
        long as samples are equal."""
        self.contents = contents

    def lacks(self, number: int, key: str) -> bool:
        """Whether a call may belong to this round."""
        return number in self.left and self.key == key

    def leave(self, numbers: set[int]) -> None:
        """Expect no call of `numbers` any more."""
        self.left -= numbers
        if not self.left and not self.doubtful:
            self.contents = ()

    def doubts(self, key: str, contents: tuple[object, ...]) -> set[int]:
        """Who may have been called for the next sample already when that begins like this."""
        return self.doubtful if self.key == key and self.contents == contents else set()


class Deduplication(Generic[T]):
    """The declarations of one session. `contents` are what tells two samples, or two queries, from each other."""

    def __init__(self, contents: Callable[[T], tuple[object, ...]]) -> None:
        self._contents = contents
        self._numbers = itertools.count()
        self._known: dict[int, tuple[zenoh.KeyExpr, bool]] = {}
        """Whatever may be called, from before it is declared until Zenoh gives it up; whether it is complete."""
        self._declaring: set[int] = set()
        self._cache: dict[str, tuple[int, ...]] = {}
        self._rounds: dict[int, _Round] = {}  # by thread: what Zenoh calls has no thread-local state in Python

    def declare(
        self,
        expression: str,
        call: Callable[[int, T], object],
        declare: Callable[[Handler], Declaration],
        *,
        complete: bool = False,
    ) -> Declaration:
        """Have `declare` make a declaration with the handler it gets. `call` gets a number, for `takes`, and what came.

        Raises what `declare` raises.
        """
        number = next(self._numbers)
        self._declaring.add(number)
        self._known[number] = zenoh.KeyExpr(expression), complete
        self._forget_matches()
        try:
            # Zenoh gives a callback up when it is undeclared and nothing is under way to it any more.
            return declare(
                zenoh.handlers.Callback(partial(call, number), partial(self._forget, number), indirect=False)
            )
        except Exception:
            self._forget(number)
            raise
        finally:
            self._declaring.discard(number)

    def covers(self, key: str) -> bool:
        """Whether any declaration matches `key`."""
        return bool(self._matching(key))

    def takes(self, number: int, key: str, what: T, *, complete: bool = False) -> bool:
        """Whether the declaration `number` hands on what it was just called with: of all called for it, one does.

        `complete`: it reaches only those that are.
        """
        matching = self._cache.get(key) or self._matching(key)
        if len(matching) == 1 and not self._rounds:  # nothing overlaps, and nothing ever did
            return True
        thread = threading.get_ident()
        # Asked first: of the others some may be given up in the middle of a round, as soon as they were called.
        current = self._rounds.pop(thread, None) if len(matching) == 1 else self._rounds.get(thread)
        if current is None and len(matching) == 1:
            return True
        contents = self._contents(what)
        if current is not None and current.lacks(number, key) and current.contents == contents:
            current.leave({number})
            return False
        if len(matching) == 1:
            return True
        left = {other for other in matching if other != number and not (complete and not self._complete(other))}
        doubtful = self._declaring if current is None else self._declaring | current.doubts(key, contents)
        self._rounds[thread] = _Round(key, left, left & doubtful, contents)
        return True

    def _complete(self, number: int) -> bool:
        return self._known.get(number, (None, False))[1]

    def _matching(self, key: str) -> tuple[int, ...]:
        cache = self._cache
        found = cache.get(key)
        if found is None:
            if len(cache) >= BOUNDS.keys:
                cache.clear()
            known = list(self._known.items())
            found = cache[key] = tuple(number for number, (own, _) in known if own.intersects(key))
        return found

    def _forget(self, number: int) -> None:
        self._known.pop(number, None)
        self._forget_matches()
        # Who was only being declared when a round began is declared by now: it was not called for that one.
        for current in list(self._rounds.values()):
            current.leave(current.doubtful | {number})

    def _forget_matches(self) -> None:
        self._cache = {}  # another one: callbacks that still fill the old one cannot spoil it


def of_sample(sample: zenoh.Sample) -> tuple[object, ...]:
    """Return what tells samples of one key from each other."""
    return sample.timestamp, sample.kind, sample.payload, sample.attachment, _source(sample.source_info)


def of_query(query: zenoh.Query) -> tuple[object, ...]:
    """Return what tells queries for one key expression from each other."""
    return str(query.parameters), query.payload, query.attachment, _source(query.source_info)


def _source(info: zenoh.SourceInfo | None) -> Hashable:
    return None if info is None else (str(info.source_id.zid), info.source_id.eid, info.source_sn)
