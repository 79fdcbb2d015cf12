"""Who subscribes to what, for any key: answers are kept until an expression that matches comes or goes."""

from collections.abc import Collection, Iterable
from functools import lru_cache

import zenoh

from proxy.core.view.tuning import TUNING


@lru_cache(maxsize=65_536)
def intersects(expression: str, key: str) -> bool:
    """Whether a subscription's key expression matches the key; an invalid one matches nothing."""
    if expression.count("**") + expression.count("$*") > TUNING.wildcards:
        return True
    one, other = _parsed(expression), _parsed(key)
    return one is not None and other is not None and bool(one.intersects(other))


def common(subscriptions: Collection[str], keys: Collection[str]) -> set[str]:
    """Return key expressions that match what both some subscription and some of the keys do, and little more."""
    if len(subscriptions) > TUNING.subscriptions_narrowed:
        return set(keys)
    return {_narrower(each, key) for each in subscriptions for key in keys if intersects(each, key)}


def _narrower(expression: str, key: str) -> str:
    """Return the narrower of two expressions that have something in common; where neither is, the first."""
    if expression.count("**") + expression.count("$*") > TUNING.wildcards:
        return key
    one, other = _parsed(expression), _parsed(key)
    return key if one is None or other is None or one.includes(other) else expression


@lru_cache(maxsize=16_384)
def _parsed(text: str) -> zenoh.KeyExpr | None:
    try:
        return zenoh.KeyExpr(text)
    except zenoh.ZError:
        return None


class Interest:
    """The subscriptions of all robots, which are named by their tags."""

    def __init__(self) -> None:
        self._of: dict[str, frozenset[str]] = {}
        self._by: dict[str, set[str]] = {}
        self._wanting: dict[tuple[str, str], tuple[str, ...]] = {}

    def set(self, tag: str, expressions: Iterable[str]) -> None:
        """The apps of a robot now subscribe to these key expressions, and no others."""
        before, after = self._of.pop(tag, frozenset()), frozenset(expressions)
        if after:
            self._of[tag] = after
        for expression in before - after:
            self._by[expression].discard(tag)
            if not self._by[expression]:
                del self._by[expression]
        for expression in after - before:
            self._by.setdefault(expression, set()).add(tag)
        self._renew(before ^ after)

    def wanting(self, key: str, publisher: str = "") -> tuple[str, ...]:
        """Return the tags of the robots whose apps subscribe to the key, in order, without that of its publisher."""
        found = self._wanting.get((key, publisher))
        if found is None:
            if len(self._wanting) >= TUNING.keys_answered:
                self._wanting.clear()
            tags: set[str] = set().union(*(by for expression, by in self._by.items() if intersects(expression, key)))
            found = self._wanting[key, publisher] = tuple(sorted(tags - {publisher}))
        return found

    def any_wanted(self, keys: Iterable[str], publisher: str) -> bool:
        """Whether any robot but the publisher subscribes to something that one of these key expressions matches."""
        others = [expression for expression, by in self._by.items() if by != {publisher}]
        return any(intersects(expression, key) for key in keys for expression in others)

    def _renew(self, changed: frozenset[str]) -> None:
        """Forget the answers that changed expressions have a part in; all of them where that is less work."""
        if len(changed) > 8:
            self._wanting.clear()
        for place in [at for at in self._wanting if any(intersects(expression, at[0]) for expression in changed)]:
            del self._wanting[place]
