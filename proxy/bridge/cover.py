"""The widest of many key expressions: subscribing to those gets all, and each sample less often."""

from collections.abc import Iterable

import zenoh


class Cover:
    """Keeps the widest of the wanted key expressions: every wanted one is included in one of them."""

    def __init__(self) -> None:
        self._over: dict[str, str | None] = {}
        self._parsed: dict[str, zenoh.KeyExpr] = {}
        self._wide: dict[str, None] = {}
        """The widest with wildcards: nothing else includes anything."""

    def update(self, wanted: Iterable[str]) -> dict[str, bool]:
        """Return the widest of `wanted`, as `Mirror` takes them."""
        wanted = set(wanted)
        gone = self._over.keys() - wanted
        for expression in gone:
            del self._over[expression], self._parsed[expression]
            self._wide.pop(expression, None)
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
        over = self._over[expression] = next((other for other in self._wide if parsed[other].includes(own)), None)
        if over is not None or "*" not in expression:
            return
        for other in [other for other, wider in self._over.items() if wider is None and other != expression]:
            if own.includes(parsed[other]):
                self._over[other] = expression
                self._wide.pop(other, None)
        self._wide[expression] = None
