"""Reads what `pickling.py` writes, and refuses everything else: a recording is what somebody sent.

Nothing in it is ever called. Objects of the classes that a snapshot may have (`layouts.py`) are made without their
constructors, and get the fields that they have; no other class, and no function, can be named.
"""

import pickletools
from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from proxy.recording.errors import RecordingError
from proxy.recording.layouts import Layout, checked_names, layout_named
from proxy.recording.spec_parts import SpecParts

DEEPEST = 8
"""Tuples within tuples that a table may have for a key: to hash one a thousand times as deep ends the process."""
_CONSTANTS: dict[str, Any] = {"NONE": None, "NEWTRUE": True, "NEWFALSE": False, "EMPTY_TUPLE": ()}
_NUMBERS = ("BINFLOAT", "BININT", "BININT1", "BININT2", "LONG1")
_ARGUMENTS = frozenset({*_NUMBERS, "SHORT_BINUNICODE", "BINUNICODE", "SHORT_BINBYTES", "BINBYTES"})
"""Opcodes that stand for their argument."""
_EMPTY: dict[str, Callable[[], Any]] = {"EMPTY_DICT": dict, "EMPTY_LIST": list, "EMPTY_SET": set}
_TUPLES = {"TUPLE1": 1, "TUPLE2": 2, "TUPLE3": 3}


def unpickled(data: bytes, parts: SpecParts) -> Any:
    """Return what a snapshot holds, with these parts of specs. Raises RecordingError for what is no snapshot."""
    machine = _Machine(parts)
    try:
        for opcode, argument, _ in pickletools.genops(data):
            machine.run(opcode.name, argument)
        (found,) = machine.stack
    except RecordingError as error:
        raise RecordingError(f"the snapshot of the core is refused: {error}") from None
    except (ArithmeticError, AttributeError, LookupError, RecursionError, TypeError, ValueError) as error:
        raise RecordingError(f"the snapshot of the core is damaged: {type(error).__name__}: {error}"[:300]) from None
    return found


@dataclass(frozen=True, slots=True)
class _Named:
    """A class or a function that the snapshot names; it never becomes a part of what is read."""

    layout: Layout | None
    name: str = ""


@dataclass(slots=True)
class _Machine:
    """The stack of a pickle, and what it remembers."""

    parts: SpecParts
    stack: list[Any] = field(default_factory=list)
    _marks: list[list[Any]] = field(default_factory=list)
    _memo: list[Any] = field(default_factory=list)

    def run(self, name: str, argument: Any) -> None:
        """Do what an opcode says. Raises RecordingError for one that no snapshot has."""
        if name in _ARGUMENTS:
            self.stack.append(argument)
        elif name in _CONSTANTS:
            self.stack.append(_CONSTANTS[name])
        elif name in _EMPTY:
            self.stack.append(_EMPTY[name]())
        elif name in _TUPLES:
            self._tuple(_TUPLES[name])
        elif name in ("BINGET", "LONG_BINGET"):
            self.stack.append(self._memo[argument])
        elif name == "MEMOIZE":
            self._memo.append(self.stack[-1])
        elif name not in ("PROTO", "FRAME", "STOP"):
            rule = _RULES.get(name)
            if rule is None:
                raise RecordingError(f"it has the opcode {name}")
            rule(self)

    def _tuple(self, length: int) -> None:
        if len(self.stack) < length:
            raise RecordingError("a tuple lacks elements")
        values = tuple(_plain(self.stack[-length:]))
        self.stack[-length:] = [values]

    def mark(self) -> None:
        """Begin a row of values."""
        self._marks.append(self.stack)
        self.stack = []

    def marked(self) -> list[Any]:
        """End a row of values, and return them."""
        values, self.stack = self.stack, self._marks.pop()
        return _plain(values)

    def pop(self) -> Any:
        """Take the last value."""
        return self.stack.pop()

    def pair(self) -> tuple[Any, Any]:
        """Take the last two values, in their order."""
        second = self.stack.pop()
        return self.stack.pop(), second


def _plain(values: list[Any]) -> list[Any]:
    """Return values that may become a part of others: no class and no function is one."""
    for each in values:
        if type(each) is _Named:
            raise RecordingError("it has a class for a value")
    return values


def _key(key: Any, depth: int = DEEPEST) -> Any:
    if isinstance(key, tuple):
        if not depth:
            raise RecordingError("a key is too deep")
        for each in key:
            _key(each, depth - 1)
    return key


def _list_of(machine: _Machine) -> None:
    values, of = machine.marked(), machine.stack[-1]
    if type(of) is not list and type(of) is not deque:
        raise RecordingError("something is added to what is no list")
    of.extend(values)


def _append(machine: _Machine) -> None:
    of, value = machine.pair()
    machine.stack.append(of)
    machine.mark()
    machine.stack.append(value)
    _list_of(machine)


def _items(machine: _Machine) -> None:
    values, of = machine.marked(), machine.stack[-1]
    if type(of) is not dict and type(of) is not Counter:
        raise RecordingError("something is set in what is no table")
    for key, value in zip(values[::2], values[1::2], strict=True):
        of[_key(key)] = value


def _item(machine: _Machine) -> None:
    key_and_value = machine.pair()
    machine.mark()
    machine.stack += key_and_value
    _items(machine)


def _set_of(machine: _Machine) -> None:
    values, of = machine.marked(), machine.stack[-1]
    if type(of) is not set:
        raise RecordingError("something is added to what is no set")
    of.update(map(_key, values))


def _frozen_set(machine: _Machine) -> None:
    values = machine.marked()
    machine.stack.append(frozenset(map(_key, values)))


def _long_tuple(machine: _Machine) -> None:
    values = machine.marked()
    machine.stack.append(tuple(values))


def _global(machine: _Machine) -> None:
    module, name = machine.pair()
    if (module, name) in _FUNCTIONS:
        machine.stack.append(_Named(None, name))
    elif isinstance(module, str) and isinstance(name, str):
        machine.stack.append(_Named(layout_named(module, name)))
    else:
        raise RecordingError("it has a name that is no text")


def _new(machine: _Machine) -> None:
    of, arguments = machine.pair()
    layout = of.layout if type(of) is _Named else None
    if layout is None or layout.member or type(arguments) is not tuple:
        raise RecordingError("it makes an object of what is no class")
    if len(arguments) != (len(layout.names or ()) if layout.named else 0):
        raise RecordingError(f"a {layout.kind.__name__} has other fields in this version")
    made = tuple.__new__(layout.kind, arguments) if layout.named else object.__new__(layout.kind)
    machine.stack.append(made)


def _build(machine: _Machine) -> None:
    of, state = machine.pair()
    kind = type(of)
    layout = layout_named(kind.__module__, kind.__qualname__)
    if layout.named or layout.member:
        raise RecordingError(f"it changes a {kind.__name__}")
    if type(state) is tuple and layout.names is not None:
        if len(state) != len(layout.names):
            raise RecordingError(f"a {kind.__name__} has other fields in this version")
        for name, value in zip(layout.names, _plain(list(state)), strict=True):
            object.__setattr__(of, name, value)
    elif type(state) is dict and layout.names is None:
        _fill(of, {name: state[name] for name in checked_names(state)})
    else:
        raise RecordingError(f"the state of a {kind.__name__} is none")
    machine.stack.append(of)


def _fill(of: Any, state: dict[str, Any]) -> None:
    """Set all that an object has; a class of ours that sets it itself does."""
    if "__setstate__" in vars(type(of)):
        of.__setstate__(state)
    else:
        vars(of).update(state)


def _reduce(machine: _Machine) -> None:
    of, arguments = machine.pair()
    if type(of) is not _Named or type(arguments) is not tuple:
        raise RecordingError("it calls what is no function")
    if of.layout is not None:
        if not of.layout.member or len(arguments) != 1:
            raise RecordingError(f"it calls {of.layout.kind.__name__}")
        machine.stack.append(of.layout.kind(*arguments))
    else:
        machine.stack.append(_made(machine.parts, of.name, arguments))


def _made(parts: SpecParts, name: str, arguments: tuple[Any, ...]) -> Any:
    """Return what stands for something else, or what can be filled."""
    match name, arguments:
        case "part", place:
            return parts.at(place)
        case "view", (dict(table),):
            return MappingProxyType(table)
        case "deque", ((), int() | None as most):
            return deque(maxlen=most)
        case "Counter", ():
            return Counter()
    raise RecordingError(f"a {name} is made of what makes none")


_FUNCTIONS = {
    ("proxy.recording.pickling", "part"),
    ("proxy.recording.pickling", "view"),
    ("collections", "deque"),
    ("collections", "Counter"),
}
_RULES: dict[str, Callable[[_Machine], object]] = {
    "MARK": _Machine.mark,
    "POP": _Machine.pop,
    "POP_MARK": _Machine.marked,
    "TUPLE": _long_tuple,
    "APPEND": _append,
    "APPENDS": _list_of,
    "SETITEM": _item,
    "SETITEMS": _items,
    "ADDITEMS": _set_of,
    "FROZENSET": _frozen_set,
    "STACK_GLOBAL": _global,
    "NEWOBJ": _new,
    "BUILD": _build,
    "REDUCE": _reduce,
}
