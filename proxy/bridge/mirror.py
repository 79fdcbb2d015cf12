"""Keeps on one session exactly the declarations that exist on the other."""

import logging
from collections.abc import Callable, Collection, Mapping

import zenoh

from proxy.bridge.declaration import Declaration

log = logging.getLogger(__name__)

MOST = 16384
"""Declarations of one kind in one direction; more are refused and said."""


class Mirror:
    """One declaration per key expression, made by `declare` and taken back when no longer wanted.

    `declare` gets the key expression and whether it is complete, which matters for queryables only.
    """

    def __init__(
        self,
        declare: Callable[[str, bool], Declaration],
        before_undeclare: Callable[[str], None] = lambda _: None,
    ) -> None:
        self._declare = declare
        self._before_undeclare = before_undeclare
        self._declared: dict[str, tuple[Declaration, bool]] = {}
        self._refused: set[str] = set()

    @property
    def declared(self) -> Collection[str]:
        """What is declared now."""
        return self._declared.keys()

    @property
    def expressions(self) -> tuple[str, ...]:
        """What is declared now, sorted."""
        return tuple(sorted(self._declared))

    def update(self, wanted: Mapping[str, bool]) -> bool:
        """Declare and undeclare until exactly `wanted` is declared; return whether anything changed."""
        altered = {
            key for key, (_, complete) in self._declared.items() if key in wanted and wanted[key] is not complete
        }
        self._take_back(altered)
        # What is new stands before what is stale goes: between them nothing that both match is missed.
        new = sorted(wanted.keys() - self._declared.keys() - self._refused)
        for expression in new:
            self._add(expression, wanted[expression])
        stale = self._declared.keys() - wanted.keys()
        self._take_back(stale)
        self._refused &= wanted.keys()
        return bool(stale or new)

    def close(self) -> None:
        """Undeclare everything."""
        self.update({})

    def _take_back(self, expressions: Collection[str]) -> None:
        for expression in expressions:
            self._before_undeclare(expression)
            self._declared.pop(expression)[0].undeclare()

    def _add(self, expression: str, complete: bool) -> None:  # noqa: FBT001 - the value of a mapping
        if len(self._declared) >= MOST:
            self._refuse(expression, f"there are {MOST} declarations already")
            return
        try:
            self._declared[expression] = (self._declare(expression, complete), complete)
        except zenoh.ZError as error:
            self._refuse(expression, error)

    def _refuse(self, expression: str, reason: object) -> None:
        self._refused.add(expression)
        log.error("%s is not mirrored: %s", expression, reason)
