"""The widest of many key expressions: subscribing to those gets all, and each sample less often."""

from collections.abc import Iterable

import zenoh


class Cover:
    """Keeps the widest of the wanted key expressions: every wanted one is included in one of them."""

    def __init__(self) -> None:
        self._over: dict[str, str | None] = {}
        self._parsed: dict[str, zenoh.KeyExpr] = {}

    def update(self, wanted: Iterable[str]) -> dict[str, bool]:
        """Return the widest of `wanted`, as `Mirror` takes them."""
        wanted = set(wanted)
        gone = self._over.keys() - wanted
        for expression in gone:
            del self._over[expression], self._parsed[expression]
        bare = [expression for expression, over in self._over.items() if over in gone]
        new = sorted(wanted - self._over.keys())
        self._parsed |= {expression: zenoh.KeyExpr(expression) for expression in new}
        for expression in (*bare, *new):
            self._place(expression)
        return {expression: False for expression, over in self._over.items() if over is None}

    def _place(self, expression: str) -> None:
        self._over.pop(expression, None)
        parsed = self._parsed
        own = parsed[expression]
        widest = [other for other, over in self._over.items() if over is None]
        self._over[expression] = next(
            (other for other in widest if "*" in other and parsed[other].includes(own)),
            None,
        )
        if "*" in expression and self._over[expression] is None:
            for other in widest:
                if own.includes(parsed[other]):
                    self._over[other] = expression
