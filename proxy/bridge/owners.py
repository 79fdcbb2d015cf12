"""Which of several overlapping declarations answers for a key.

Zenoh calls every matching subscriber and queryable of a session, so one sample for `a/b` arrives twice where
both `a/*` and `a/b` are declared. Exactly one of them, the owner, hands it on.
"""

import threading

import zenoh

_CACHED = 8192


class _Round:
    """The calls for one sample or query, which Zenoh makes one after the other on one thread."""

    __slots__ = ("among", "key", "left")

    def __init__(self, key: str, among: tuple[str, ...], called: str) -> None:
        self.key = key
        self.among = among
        self.left = {name for name in among if name != called}

    def goes_on(self, expression: str, key: str) -> bool:
        """Whether a call belongs to this round; it does so only once."""
        if self.key != key or expression not in self.left:
            return False
        self.left.discard(expression)
        return True


class Owners:
    """The expressions declared on one session, oldest first: the oldest that matches a key owns it."""

    def __init__(self) -> None:
        self._expressions: dict[str, zenoh.KeyExpr] = {}
        self._cache: dict[str, tuple[str, ...]] = {}
        self._rounds: dict[int, _Round] = {}  # by thread: what Zenoh calls has no thread-local state in Python

    def add(self, expression: str) -> None:
        """Let `expression` own what no older one owns. Call it before declaring."""
        self._replace({**self._expressions, expression: zenoh.KeyExpr(expression)})

    def discard(self, expression: str) -> None:
        """Let others own what `expression` owned. Call it before undeclaring."""
        self._replace({name: key for name, key in self._expressions.items() if name != expression})

    def owner(self, key: str) -> str | None:
        """Return the expression that owns `key` (a key or, for a query, a key expression)."""
        matching = self._matching(key)
        return matching[0] if matching else None

    def takes(self, expression: str, key: str) -> bool:
        """Whether `expression` is the one to hand on what it was just called with: exactly one of all called is.

        The owner of a round stays when it changes meanwhile, or both the old and the new one might hand it on, or none.
        """
        matching = self._cache.get(key, ())
        if len(matching) == 1 and not self._rounds:  # nothing overlaps, and nothing ever did
            return matching[0] == expression
        thread = threading.get_ident()
        current = self._rounds.get(thread)
        if current is not None and current.goes_on(expression, key):
            return current.among[0] == expression
        matching = self._matching(key)
        if len(matching) > 1:
            self._rounds[thread] = _Round(key, matching, expression)
        return bool(matching) and matching[0] == expression

    def first(self, expression: str, key: str) -> bool:
        """Whether a call of `expression` is the first one for a query.

        For queries the owner does not do: one that asks for complete queryables does not reach the others.
        """
        matching = self._matching(key)
        thread = threading.get_ident()
        current = self._rounds.get(thread)
        if current is not None and current.among is matching and current.goes_on(expression, key):
            return False
        self._rounds[thread] = _Round(key, matching, expression)
        return True

    def _matching(self, key: str) -> tuple[str, ...]:
        cache = self._cache
        found = cache.get(key)
        if found is None:
            if len(cache) >= _CACHED:
                cache.clear()
            found = cache[key] = tuple(name for name, own in self._expressions.items() if own.intersects(key))
        return found

    def _replace(self, expressions: dict[str, zenoh.KeyExpr]) -> None:
        # A new cache: callbacks that still fill the old one cannot spoil it.
        self._expressions, self._cache = expressions, {}
