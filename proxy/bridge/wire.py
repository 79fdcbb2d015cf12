"""Reads Zenoh's wire protocol (version 9) just far enough to know what is declared.

A batch holds transport messages, a frame network messages, with no length before each: so all are parsed, and all but
declarations are skipped. Integers are LEB128, extensions carry their own size.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

Kind = Literal["subscriber", "queryable", "token"]


class WireError(ValueError):
    """Bytes that are not what this reader knows of the protocol."""


@dataclass(frozen=True, slots=True)
class KeyNumber:
    """A node will write `number` for a key expression from now on."""

    number: int
    scope: int
    suffix: str
    senders: bool


@dataclass(frozen=True, slots=True)
class Declared:
    """Something was declared: `scope` is a number of the sender's (`senders`) or of the receiver's, 0 for none."""

    kind: Kind
    number: int
    scope: int
    suffix: str
    senders: bool
    complete: bool


@dataclass(frozen=True, slots=True)
class Undeclared:
    """It was taken back: by its number, or by its key expression where there is one."""

    kind: Kind
    number: int
    scope: int
    suffix: str
    senders: bool

    @property
    def by_expression(self) -> bool:
        """Whether the key expression tells, not the number."""
        return bool(self.scope or self.suffix)


Declaration = KeyNumber | Declared | Undeclared

_Z, _N, _M = 0x80, 0x20, 0x40
_DECLARED: dict[int, Kind] = {0x02: "subscriber", 0x04: "queryable", 0x06: "token"}
_UNDECLARED: dict[int, Kind] = {0x03: "subscriber", 0x05: "queryable", 0x07: "token"}


class _Bytes:
    """A cursor over bytes."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._at = 0

    def __bool__(self) -> bool:
        return self._at < len(self._data)

    def byte(self) -> int:
        if self._at >= len(self._data):
            raise WireError("a message ends early")
        self._at += 1
        return self._data[self._at - 1]

    def take(self, size: int) -> bytes:
        if self._at + size > len(self._data):
            raise WireError("a message ends early")
        self._at += size
        return self._data[self._at - size : self._at]

    def rest(self) -> bytes:
        return self.take(len(self._data) - self._at)

    def number(self) -> int:
        value = 0
        for shift in range(0, 63, 7):
            byte = self.byte()
            if shift == 56:  # the ninth byte holds eight bits
                return value | byte << shift
            value |= (byte & 0x7F) << shift
            if byte < 0x80:
                return value
        raise WireError("unreachable")

    def sized(self) -> bytes:
        return self.take(self.number())

    def text(self) -> str:
        return self.sized().decode()

    def extensions(self, header: int) -> dict[int, int | bytes]:
        """What follows a header with the Z flag, by id."""
        found: dict[int, int | bytes] = {}
        while header & _Z:
            header = self.byte()
            found[header & 0x0F] = self._extension(header)
        return found

    def _extension(self, header: int) -> int | bytes:
        encoding = header & 0x60
        if encoding == 0x60:
            raise WireError("an extension of unknown encoding")
        return self.sized() if encoding == 0x40 else self.number() if encoding == 0x20 else 0

    def expression(self, header: int) -> tuple[int, str, bool]:
        """A key expression: scope, suffix, and whether the scope is the sender's number."""
        scope = self.number()
        return scope, self.text() if header & _N else "", bool(header & _M)


class Batches:
    """Cuts one direction of a TCP link into batches and yields the declarations in them."""

    def __init__(self) -> None:
        self._buffer = bytearray()
        self._fragments: dict[bool, bytearray] = {}

    def feed(self, data: bytes) -> Iterator[Declaration]:
        """Take in what the link carried. Raises WireError."""
        self._buffer += data
        while len(self._buffer) >= 2:
            size = int.from_bytes(self._buffer[:2], "little")
            if len(self._buffer) < size + 2:
                return
            batch = bytes(self._buffer[2 : size + 2])
            del self._buffer[: size + 2]
            yield from self._transport(_Bytes(batch))

    def _transport(self, data: _Bytes) -> Iterator[Declaration]:
        while data:
            header = data.byte()
            match header & 0x1F:
                case 0x04:  # keep alive
                    data.extensions(header)
                case 0x05:  # frame
                    data.number()
                    data.extensions(header)
                    yield from _network(data)
                case 0x06:  # fragment
                    data.number()
                    data.extensions(header)
                    yield from self._fragment(header, data.rest())
                case 0x00 | 0x01 | 0x02 | 0x03:  # handshake, close, out of band: fill their batch
                    return
                case other:
                    raise WireError(f"a transport message of unknown kind {other:#x}")

    def _fragment(self, header: int, part: bytes) -> Iterator[Declaration]:
        reliable, more = bool(header & 0x20), bool(header & 0x40)
        whole = self._fragments.setdefault(reliable, bytearray())
        whole += part
        if not more:
            del self._fragments[reliable]
            yield from _network(_Bytes(bytes(whole)))


def _network(data: _Bytes) -> Iterator[Declaration]:
    while data:
        header = data.byte()
        kind = header & 0x1F
        if kind == 0x1E:
            if header & 0x20:
                data.number()
            data.extensions(header)
            declaration = _declaration(data)
            if declaration is not None:
                yield declaration
        elif kind in _SKIPPED:
            _SKIPPED[kind](data, header)
        else:
            raise WireError(f"a network message of unknown kind {kind:#x}")


def _declaration(data: _Bytes) -> Declaration | None:
    header = data.byte()
    kind = header & 0x1F
    if kind == 0x00:
        number = data.number()
        scope, suffix, senders = data.expression(header)
        data.extensions(header)
        return KeyNumber(number, scope, suffix, senders)
    if kind in _DECLARED:
        number = data.number()
        expression = data.expression(header)
        info = data.extensions(header).get(1, 0)
        return Declared(_DECLARED[kind], number, *expression, complete=isinstance(info, int) and bool(info & 1))
    if kind in _UNDECLARED:
        number = data.number()
        return Undeclared(_UNDECLARED[kind], number, *_expression_in(data.extensions(header).get(0x0F, b"")))
    if kind in (0x01, 0x1A):  # a key number given back (never reused in a session), or the end of a list
        if kind == 0x01:
            data.number()
        data.extensions(header)
        return None
    raise WireError(f"a declaration of unknown kind {kind:#x}")


def _expression_in(extension: int | bytes) -> tuple[int, str, bool]:
    data = _Bytes(extension if isinstance(extension, bytes) else b"")
    if not data:
        return 0, "", False
    flags = data.byte()
    scope = data.number()
    return scope, data.rest().decode() if flags & 0x01 else "", bool(flags & 0x02)


def _out_of_band(data: _Bytes, header: int) -> None:
    data.number()
    data.extensions(header)
    if header & 0x60 == 0x40:
        data.sized()
    elif header & 0x60 == 0x20:
        data.number()


def _push(data: _Bytes, header: int) -> None:
    data.expression(header)
    data.extensions(header)
    _body(data)


def _request(data: _Bytes, header: int) -> None:
    data.number()
    _push(data, header)


def _response_final(data: _Bytes, header: int) -> None:
    data.number()
    data.extensions(header)


def _interest(data: _Bytes, header: int) -> None:
    data.number()
    if header & 0x60:  # current, future or both; neither ends an interest
        options = data.byte()
        if options & 0x10:
            data.expression(options)
    data.extensions(header)


def _body(data: _Bytes) -> None:
    """What a push, request or response is about."""
    header = data.byte()
    match header & 0x1F:
        case 0x01 | 0x05:  # put, error
            _value(data, header)
        case 0x02:  # delete
            _stamp(data, header)
            data.extensions(header)
        case 0x03:  # query
            _consolidation(data, header)
            if header & 0x40:
                data.sized()
            data.extensions(header)
        case 0x04:  # reply
            _consolidation(data, header)
            data.extensions(header)
            _body(data)
        case other:
            raise WireError(f"a body of unknown kind {other:#x}")


def _value(data: _Bytes, header: int) -> None:
    _stamp(data, header)
    if header & 0x40 and data.number() & 1:  # an encoding, with a schema
        data.sized()
    data.extensions(header)
    data.sized()


def _stamp(data: _Bytes, header: int) -> None:
    if header & 0x20:
        data.number()
        data.sized()


def _consolidation(data: _Bytes, header: int) -> None:
    if header & 0x20:
        data.byte()


_SKIPPED: dict[int, Callable[[_Bytes, int], None]] = {
    0x1F: _out_of_band,
    0x1D: _push,
    0x1C: _request,
    0x1B: _request,
    0x1A: _response_final,
    0x19: _interest,
}
