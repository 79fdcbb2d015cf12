"""Keeps on one session exactly the declarations that exist on the other."""

import logging
from collections.abc import Callable, Collection, Mapping

import zenoh

from proxy import clock
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.declaration import Declaration

log = logging.getLogger(__name__)


class Mirror:
    """One declaration per key expression, made by `declare` and taken back when no longer wanted.

    `declare` gets the key expression and whether it is complete, which matters for queryables only. What is declared
    anew has `grace` [s] before what it may replace goes: samples under way by then do not know it yet.
    """

    def __init__(
        self,
        declare: Callable[[str, bool], Declaration],
        grace: float = 0.0,
    ) -> None:
        self._declare = declare
        self._declared: dict[str, tuple[Declaration, bool]] = {}
        self._refused: set[str] = set()
        self._grace = grace
        self._settled_at = 0.0
        self._leaving: dict[str, float] = {}

    @property
    def declared(self) -> Collection[str]:
        """What is declared now."""
        return self._declared.keys()

    @property
    def expressions(self) -> tuple[str, ...]:
        """What is declared now, sorted."""
        return tuple(sorted(self._declared))

    @property
    def leaving(self) -> bool:
        """Whether something waits to be taken back: `update` has to be called again."""
        return bool(self._leaving)

    def update(self, wanted: Mapping[str, bool], ended: Collection[str] = ()) -> bool:
        """Declare and undeclare until exactly `wanted` is declared; return whether anything changed.

        What has `ended`, and is wanted again by now, ends here too before it is declared anew.
        """
        self._take_back([expression for expression in ended if expression in self._declared])
        altered = {
            key for key, (_, complete) in self._declared.items() if key in wanted and wanted[key] is not complete
        }
        former = [self._declared.pop(key)[0] for key in altered]
        new = sorted(wanted.keys() - self._declared.keys() - self._refused)
        try:
            for expression in new:
                self._add(expression, wanted[expression])
        finally:
            for declared in former:  # only now: there is one all the time
                declared.undeclare()
        now = clock.monotonic()
        if new:
            self._settled_at = now + self._grace
        stale = self._declared.keys() - wanted.keys()
        self._leaving = {name: self._leaving.get(name, self._settled_at) for name in stale}
        gone = [name for name, due in self._leaving.items() if due <= now]
        self._take_back(gone)
        self._refused &= wanted.keys()
        return bool(gone or new)

    def show(self, expression: str) -> None:
        """Declare what is not, and take it back at once; where there is no room nothing, and without a word.

        Each is another one: a line for each in the log would be as many as an application declares.
        """
        if len(self._declared) >= BOUNDS.declarations:
            return
        self._add(expression, complete=False)
        self._take_back((expression,))
        self._refused.discard(expression)

    def close(self) -> None:
        """Undeclare everything."""
        self._take_back(list(self._declared))

    def _take_back(self, expressions: Collection[str]) -> None:
        for expression in expressions:
            self._leaving.pop(expression, None)
            declared = self._declared.pop(expression, None)  # gone when closed in the middle of a look
            if declared is not None:
                declared[0].undeclare()

    def _add(self, expression: str, complete: bool) -> None:  # noqa: FBT001 - the value of a mapping
        if len(self._declared) >= BOUNDS.declarations:
            self._refuse(expression, f"there are {BOUNDS.declarations} declarations already")
            return
        try:
            self._declared[expression] = (self._declare(expression, complete), complete)
        except zenoh.ZError as error:
            self._refuse(expression, error)

    def _refuse(self, expression: str, reason: object) -> None:
        self._refused.add(expression)
        log.error("%s is not mirrored: %s", expression, reason)
