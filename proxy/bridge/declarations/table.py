"""Who declares what on the far side of a tapped link, and how it asks, kept from the bytes that pass."""

import logging
import math
import threading
from collections import Counter, OrderedDict, deque
from collections.abc import Callable, Mapping

from proxy import clock
from proxy.bridge.declarations.cursor import WireError
from proxy.bridge.declarations.tuning import TUNING
from proxy.bridge.declarations.wire import Asked, Batches, Declared, Interest, KeyNumber, Kind, Message, Undeclared
from proxy.bridge.keys import crosses

log = logging.getLogger(__name__)


class DeclarationTable:
    """What the main session declares to the mirror session, that is: what all others declared to the main session.

    `changed` is called after each change. When the protocol is not understood the table stays as it is: `broken`.
    `edition` grows with every change of what is declared.
    """

    def __init__(self, changed: Callable[[], None]) -> None:
        self.broken = False
        self.edition = 0
        self._changed = changed
        self._lock = threading.Lock()
        self._entries: dict[Kind, dict[int | str, tuple[str, bool]]] = {}
        self._merged: dict[Kind, dict[str, bool]] = {}
        self._alive = Counter[str]()
        """How many tokens there are of each name..."""
        self._ended: set[str] = set()
        """... and those names of which there was none, at some time since somebody asked."""
        self._asked: OrderedDict[tuple[str, str], deque[tuple[float, Asked]]] = OrderedDict()
        """The queries that are not taken yet, by key expression and parameters, each with the end of its time [s]."""
        self.reset()

    def reset(self) -> None:
        """Begin anew, with a new link."""
        with self._lock:
            self._entries = {"subscriber": {}, "queryable": {}, "token": {}}
            self._merged.clear()
            self._alive.clear()
            self._asked.clear()
            self.edition += 1
            self._batches = (Batches(), Batches())
            self._numbers: tuple[dict[int, str], dict[int, str]] = ({}, {})

    def declared(self, kind: Kind) -> Mapping[str, bool]:
        """Return the key expressions that cross; for queryables whether a complete one is among them.

        The same mapping until something changes.
        """
        with self._lock:
            found = self._merged.get(kind)
            if found is None:  # something has changed since
                found = self._merged[kind] = {}
                for expression, complete in self._entries[kind].values():
                    found[expression] = complete or found.get(expression, False)
            return found

    def entries(self, kind: Kind) -> Mapping[int | str, tuple[str, bool]]:
        """Return what is declared now: key expressions, and whether they are complete, by what names each."""
        with self._lock:
            return dict(self._entries[kind])

    def remove(self, kind: Kind, gone: Mapping[int | str, tuple[str, bool]]) -> None:
        """Take out of these entries what nobody declared anew meanwhile: they are gone, though nobody said so."""
        with self._lock:
            for name, entry in gone.items():
                if self._entries[kind].get(name) is entry:
                    self._forget(kind, name)
            self._change(kind)
        self._changed()

    def ended_tokens(self) -> set[str]:
        """Return the tokens that ended since the last call: they may be alive again by now."""
        with self._lock:
            ended, self._ended = self._ended, set()
            return ended

    def asked(self, expression: str, parameters: str) -> Asked | None:
        """Return what `take` would."""
        with self._lock:
            waiting = self._untaken(expression, parameters)
            return waiting[0][1] if waiting else None

    def take(self, expression: str, parameters: str) -> Asked | None:
        """Return how the oldest query that is not taken yet was asked; None when it is not known."""
        with self._lock:
            waiting = self._untaken(expression, parameters)
            asked = waiting.popleft()[1] if waiting else None
            if not waiting:
                self._asked.pop((expression, parameters), None)
            return asked

    def read(self, data: bytes, *, inward: bool) -> None:
        """Take in what went from the main session to the mirror session (`inward`) or the other way."""
        if self.broken:
            return
        before = self.edition
        try:
            with self._lock:
                for message in self._batches[inward].feed(data):
                    self._enter(message, inward=inward)
        except (WireError, UnicodeDecodeError, KeyError) as error:
            self.give_up(repr(error))
            return
        if self.edition != before:
            self._changed()

    def give_up(self, reason: str) -> None:
        """Say that the link cannot be followed, and read no more."""
        self.broken = True
        self.edition += 1
        log.error("cannot follow Zenoh's declarations, everything is bridged from now on: %s", reason)
        self._changed()

    def _enter(self, message: Message, *, inward: bool) -> None:
        match message:
            case KeyNumber():
                self._numbers[inward][message.number] = self._expression(message, inward=inward)
            case Interest():
                pass
            case Asked() if inward:
                self._remember(message)
            case Declared() if inward:
                expression = self._expression(message, inward=inward)
                if crosses(expression):
                    # Routers number nothing: there the key expression is the name.
                    self._add(message.kind, message.number or expression, (expression, message.complete))
                    self._change(message.kind)
            case Undeclared() if inward:
                by_name = message.by_expression
                gone = self._expression(message, inward=inward) if by_name else message.number
                if self._forget(message.kind, gone):
                    self._change(message.kind)

    def _add(self, kind: Kind, name: int | str, entry: tuple[str, bool]) -> None:
        """Put an entry in; an equal one may be there."""
        if self._entries[kind].get(name) != entry:
            self._forget(kind, name)
            if kind == "token":
                self._alive[entry[0]] += 1
        self._entries[kind][name] = entry

    def _forget(self, kind: Kind, name: int | str) -> bool:
        """Take an entry out; whether there was one."""
        entry = self._entries[kind].pop(name, None)
        if entry is not None and kind == "token":
            self._alive[entry[0]] -= 1
            if not self._alive[entry[0]]:
                del self._alive[entry[0]]
                self._ended.add(entry[0])
        return entry is not None

    def _change(self, kind: Kind) -> None:
        self._merged.pop(kind, None)
        self.edition += 1

    def _untaken(self, expression: str, parameters: str) -> deque[tuple[float, Asked]] | None:
        """Return the queries of a name that may still be taken."""
        waiting, now = self._asked.get((expression, parameters)), clock.monotonic()
        while waiting and waiting[0][0] < now:
            waiting.popleft()
        return waiting

    def _remember(self, asked: Asked) -> None:
        name = self._expression(asked, inward=True), asked.parameters
        until = clock.monotonic() + min(TUNING.query_taken, math.inf if asked.timeout is None else asked.timeout)
        self._asked.setdefault(name, deque(maxlen=TUNING.queries_remembered)).append((until, asked))
        while len(self._asked) > TUNING.queries_remembered:
            self._asked.popitem(last=False)

    def _expression(self, named: KeyNumber | Declared | Undeclared | Asked, *, inward: bool) -> str:
        if not named.scope:
            return named.suffix
        return self._numbers[inward == named.senders][named.scope] + named.suffix
