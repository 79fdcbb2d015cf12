"""Which of several overlapping declarations answers for a key.

Zenoh calls every matching subscriber and queryable of a session, so one sample for `a/b` arrives twice where
both `a/*` and `a/b` are declared. Exactly one of them, the owner, hands it on.
"""

import threading

import zenoh

_CACHED = 8192


class _Round(threading.local):
    """The calls for one sample or query, which Zenoh makes one after the other on one thread."""

    key = ""
    owner = ""
    left: frozenset[str] = frozenset()


class Owners:
    """The expressions declared on one session, oldest first: the oldest that matches a key owns it."""

    def __init__(self) -> None:
        self._expressions: dict[str, zenoh.KeyExpr] = {}
        self._cache: dict[str, tuple[str, ...]] = {}
        self._round = _Round()

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
        current = self._round
        if current.left and current.key == key and expression in current.left:
            current.left -= {expression}
            return current.owner == expression
        matching = self._matching(key)
        if len(matching) > 1:
            current.key, current.owner, current.left = key, matching[0], frozenset(matching) - {expression}
        return bool(matching) and matching[0] == expression

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
