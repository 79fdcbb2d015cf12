"""Tells what others subscribe to from what we do.

The wire tells that somebody besides the mirror session subscribes to a key expression, and that may be the main session
itself. What others want the main session is told, by the matching status of a publisher; but that is true of every
subscriber that intersects. So for each expression of our own a publisher stands witness on keys made for it, which no
narrower expression matches: chunks nobody uses in place of wildcards. What others want more widely tells a witness too;
but then the same keys cross either way.
"""

from collections.abc import Callable, Collection, Mapping
from functools import partial

import zenoh

from proxy.bridge.declaration import Declaration, matches
from proxy.bridge.declarations.tuning import TUNING

_FRESH = "~sendworthy~"
"""A chunk that no application uses."""


class Witnesses:
    """Stands for the subscribers of one main session, `session`. `changed` is called when a witness turns."""

    def __init__(self, session: zenoh.Session, changed: Callable[[], None]) -> None:
        self._session = session
        self._changed = changed
        self._standing: dict[str, tuple[zenoh.Publisher, ...]] = {}
        self._known: dict[str, bool] = {}
        self._turned: set[str] = set()
        self._leaving: dict[str, float] = {}

    @property
    def waiting(self) -> bool:
        """Whether `others` must be asked again although nothing else is told."""
        return bool(self._leaving or self._turned)

    def others(self, told: Mapping[str, bool], own: Collection[str], now: float) -> dict[str, bool]:
        """Return what of `told` others subscribe to, `own` being what the main session does.

        What was our own only a moment ago still has its witness: the wire may not have been told of the end.
        """
        for expression in own:
            if expression not in self._standing:
                self._standing[expression] = tuple(self._call(key, expression) for key in examples(expression))
                self._turned.add(expression)
            self._leaving.pop(expression, None)
        for expression in [name for name in self._standing if name not in own]:
            until = self._leaving.setdefault(expression, now + TUNING.echo)
            if now >= until and expression not in told:
                self._dismiss(expression)
        self._hear()
        return {name: False for name in told if self._known.get(name, True)}

    def ask(self) -> bool:
        """Ask all that know of nobody, and hear those that turned; return whether any knows otherwise than before.

        What turns them is told a moment later. Whoever asks takes what `others` would have found to be new: when that
        somebody had left was not passed on, what had been mirrored for it stayed for good, and its copies on the air.
        """
        before = dict(self._known)
        self._turned |= {name for name, known in self._known.items() if not known}
        self._hear()
        return self._known != before

    def close(self) -> None:
        """Let all witnesses go."""
        for expression in list(self._standing):
            self._dismiss(expression)

    def _hear(self) -> None:
        """Hear those that turned: each costs a look of Zenoh's at all subscribers there are."""
        while self._turned:
            expression = self._turned.pop()
            if expression in self._standing:
                self._known[expression] = all(matches(witness) for witness in self._standing[expression])

    def _call(self, key: str, expression: str) -> zenoh.Publisher:
        witness = self._session.declare_publisher(key, allowed_destination=zenoh.Locality.REMOTE)
        handler = zenoh.handlers.Callback(partial(self._turn, expression), indirect=False)
        witness.declare_matching_listener(handler)
        return witness

    def _turn(self, expression: str, _: zenoh.MatchingStatus) -> None:
        # What it says is not kept: of two turns in quick succession the later may be told first.
        self._turned.add(expression)
        self._changed()

    def _dismiss(self, expression: str) -> None:
        self._leaving.pop(expression, None)
        self._known.pop(expression, None)
        witnesses: tuple[Declaration, ...] = self._standing.pop(expression)
        for witness in witnesses:
            witness.undeclare()


def examples(expression: str) -> tuple[str, ...]:
    """Return keys that `expression` matches and no narrower one does: for `**` a short and a long one."""
    chunks = expression.replace("$*", _FRESH).split("/")
    if "**" not in chunks:
        return (_example(chunks, 0),)
    return _example(chunks, 0) or _FRESH, _example(chunks, TUNING.witness_depth)


def _example(chunks: list[str], depth: int) -> str:
    filled: list[str] = []
    for chunk in chunks:
        filled += [_FRESH] * depth if chunk == "**" else [_FRESH if chunk == "*" else chunk]
    return "/".join(filled)
