"""Which of several overlapping declarations answers for a key.

Zenoh calls every matching subscriber and queryable of a session, so one sample for `a/b` arrives twice where
both `a/*` and `a/b` are declared. Exactly one of them, the owner, hands it on.
"""

import zenoh

_CACHED = 8192


class Owners:
    """The expressions declared on one session, oldest first: the oldest that matches a key owns it."""

    def __init__(self) -> None:
        self._expressions: dict[str, zenoh.KeyExpr] = {}
        self._cache: dict[str, str | None] = {}

    def add(self, expression: str) -> None:
        """Let `expression` own what no older one owns. Call it before declaring."""
        self._replace({**self._expressions, expression: zenoh.KeyExpr(expression)})

    def discard(self, expression: str) -> None:
        """Let others own what `expression` owned. Call it before undeclaring."""
        self._replace({name: key for name, key in self._expressions.items() if name != expression})

    def owner(self, key: str) -> str | None:
        """Return the expression that owns `key` (a key or, for a query, a key expression)."""
        cache = self._cache
        if key not in cache:
            if len(cache) >= _CACHED:
                cache.clear()
            cache[key] = next((name for name, own in self._expressions.items() if own.intersects(key)), None)
        return cache.get(key)

    def _replace(self, expressions: dict[str, zenoh.KeyExpr]) -> None:
        # A new cache: callbacks that still fill the old one cannot spoil it.
        self._expressions, self._cache = expressions, {}
