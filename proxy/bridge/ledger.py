"""Who declares what on the far side of a tapped link, kept from the bytes that pass."""

import logging
import threading
from collections.abc import Callable

from proxy.bridge.keys import crosses
from proxy.bridge.wire import Batches, Declared, KeyNumber, Kind, Undeclared, WireError

log = logging.getLogger(__name__)


class Ledger:
    """What the main session declares to the voice, that is: what all others declared to the main session.

    `changed` is called after each change. When the protocol is not understood the ledger stays as it is: `broken`.
    """

    def __init__(self, changed: Callable[[], None]) -> None:
        self.broken = False
        self._changed = changed
        self._lock = threading.Lock()
        self._entries: dict[tuple[Kind, int | str], tuple[str, bool]] = {}
        self.reset()

    def reset(self) -> None:
        """Begin anew, with a new link."""
        with self._lock:
            self._entries.clear()
            self._batches = (Batches(), Batches())
            self._numbers: tuple[dict[int, str], dict[int, str]] = ({}, {})

    def declared(self, kind: Kind) -> dict[str, bool]:
        """Return the key expressions that cross; for queryables whether a complete one is among them."""
        found: dict[str, bool] = {}
        with self._lock:
            for (entry, _), (expression, complete) in self._entries.items():
                if entry == kind and crosses(expression):
                    found[expression] = complete or found.get(expression, False)
        return found

    def read(self, data: bytes, *, inward: bool) -> None:
        """Take in what went from the main session to the voice (`inward`) or the other way."""
        if self.broken:
            return
        news = False
        try:
            with self._lock:
                for declaration in self._batches[inward].feed(data):
                    news |= self._enter(declaration, inward=inward)
        except (WireError, UnicodeDecodeError, KeyError) as error:
            self.broken = True
            news = True
            log.error("cannot follow Zenoh's declarations, everything is bridged from now on: %r", error)
        if news:
            self._changed()

    def _enter(self, declaration: KeyNumber | Declared | Undeclared, *, inward: bool) -> bool:
        if isinstance(declaration, KeyNumber):
            self._numbers[inward][declaration.number] = self._expression(declaration, inward=inward)
            return False
        if not inward:
            return False
        if isinstance(declaration, Declared):
            expression = self._expression(declaration, inward=inward)
            # Routers number nothing: there the key expression is the name.
            name = declaration.number or expression
            self._entries[declaration.kind, name] = (expression, declaration.complete)
            return True
        by_name = declaration.by_expression
        gone = self._expression(declaration, inward=inward) if by_name else declaration.number
        return self._entries.pop((declaration.kind, gone), None) is not None

    def _expression(self, told: KeyNumber | Declared | Undeclared, *, inward: bool) -> str:
        if not told.scope:
            return told.suffix
        return self._numbers[inward == told.senders][told.scope] + told.suffix
