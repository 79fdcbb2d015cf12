"""Reads Zenoh's wire protocol (version 9) just far enough to know what is declared and how it is asked.

A batch holds transport messages, a frame network messages, with no length before each: so all are parsed, and all but
declarations, interests and queries are skipped.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

from proxy.bridge.declarations.cursor import Cursor, WireError

Kind = Literal["subscriber", "queryable", "token"]


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


@dataclass(frozen=True, slots=True)
class Interest:
    """Somebody wants to be told of what is declared on a key expression.

    `options` is where in its batch the byte stands that says of what, `end` where the key expression after it ends.
    """

    scope: int
    suffix: str
    options: int
    end: int


@dataclass(frozen=True, slots=True)
class Asked:
    """A query, and how it is asked: `target` is Zenoh's number of it, the timeout is in [s].

    `qos` holds the priority in its three lowest bits, then whether it waits for room, and whether it is express.
    """

    scope: int
    suffix: str
    senders: bool
    parameters: str
    target: int
    timeout: float | None
    qos: int


Message = KeyNumber | Declared | Undeclared | Interest | Asked

RESTRICTED = 0x10
"""Flag of an interest: a key expression follows."""
_QOS, _TARGET, _TIMEOUT = 0x1, 0x4, 0x6

_FRAGMENT_QOS, _FIRST, _GIVEN_UP = 0x1, 0x2, 0x3
"""Extensions of a fragment: its priority, and the marks of a message's first one and of a message that is given up."""
_USUAL = 0x05
"""The priority where none is said."""

_DECLARED: dict[int, Kind] = {0x02: "subscriber", 0x04: "queryable", 0x06: "token"}
_UNDECLARED: dict[int, Kind] = {0x03: "subscriber", 0x05: "queryable", 0x07: "token"}


class Batches:
    """Cuts one direction of a stream into batches and yields the messages in them."""

    def __init__(self) -> None:
        self._buffer = bytearray()
        self._fragments: dict[tuple[bool, int], bytearray] = {}
        """The messages of which not all parts have come, by whether they are reliable, and by priority."""

    def feed(self, data: bytes) -> Iterator[Message]:
        """Take in what the link carried. Raises WireError."""
        self._buffer += data
        while len(self._buffer) >= 2:
            size = int.from_bytes(self._buffer[:2], "little")
            if len(self._buffer) < size + 2:
                return
            batch = bytes(self._buffer[2 : size + 2])
            del self._buffer[: size + 2]
            yield from self.read(batch)

    def read(self, batch: bytes) -> Iterator[Message]:
        """Yield the messages of one batch. Raises WireError."""
        data = Cursor(batch)
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
                    yield from self._fragment(header, data.extensions(header), data.rest())
                case 0x00 | 0x01 | 0x02 | 0x03:  # handshake, close, out of band: fill their batch
                    return
                case other:
                    raise WireError(f"a transport message of unknown kind {other:#x}")

    def _fragment(self, header: int, said: dict[int, int | bytes], part: bytes) -> Iterator[Message]:
        """A part of a message. Those of several priorities come interleaved, and Zenoh may give one up half-way."""
        more, qos = bool(header & 0x40), said.get(_FRAGMENT_QOS, _USUAL)
        lane = bool(header & 0x20), (qos if isinstance(qos, int) else _USUAL) & 0x07
        if _FIRST in said or _GIVEN_UP in said:
            self._fragments.pop(lane, None)
        if _GIVEN_UP in said:
            return
        whole = self._fragments.setdefault(lane, bytearray())
        whole += part
        if not more:
            del self._fragments[lane]
            for message in _network(Cursor(bytes(whole))):
                if not isinstance(message, Interest):  # which would say where it stands in its batch
                    yield message


def _network(data: Cursor) -> Iterator[Message]:
    while data:
        header = data.byte()
        kind = header & 0x1F
        if kind < 0x08:  # the frame is over, another transport message follows
            data.step_back()
            return
        reader = _READ.get(kind)
        if reader is None:
            raise WireError(f"a network message of unknown kind {kind:#x}")
        message = reader(data, header)
        if message is not None:
            yield message


def _declare(data: Cursor, header: int) -> Message | None:
    if header & 0x20:
        data.number()
    data.extensions(header)
    return _declaration(data)


def _declaration(data: Cursor) -> Message | None:
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
    data = Cursor(extension if isinstance(extension, bytes) else b"")
    if not data:
        return 0, "", False
    flags = data.byte()
    scope = data.number()
    return scope, data.rest().decode() if flags & 0x01 else "", bool(flags & 0x02)


def _out_of_band(data: Cursor, header: int) -> None:
    data.number()
    data.extensions(header)
    if header & 0x60 == 0x40:
        data.sized()
    elif header & 0x60 == 0x20:
        data.number()


def _push(data: Cursor, header: int) -> None:
    data.expression(header)
    data.extensions(header)
    _body(data)


def _request(data: Cursor, header: int) -> Asked:
    data.number()
    expression = data.expression(header)
    said = {name: value for name, value in data.extensions(header).items() if isinstance(value, int)}
    timeout = said.get(_TIMEOUT)
    return Asked(
        *expression,
        parameters=_body(data),
        target=said.get(_TARGET, 0),
        timeout=None if timeout is None else timeout / 1000,
        qos=said.get(_QOS, 0x05),
    )


def _response(data: Cursor, header: int) -> None:
    data.number()
    _push(data, header)


def _response_final(data: Cursor, header: int) -> None:
    data.number()
    data.extensions(header)


def _interest(data: Cursor, header: int) -> Interest | None:
    found = None
    data.number()
    if header & 0x60:  # current, future or both; neither ends an interest
        at = data.at
        options = data.byte()
        if options & RESTRICTED:
            scope, suffix, _ = data.expression(options)
            found = Interest(scope, suffix, options=at, end=data.at)
    data.extensions(header)
    return found


def _body(data: Cursor) -> str:
    """Read what a push, request or response is about; return the parameters of a query."""
    header = data.byte()
    parameters = ""
    match header & 0x1F:
        case 0x01 | 0x05:  # put, error
            _value(data, header)
        case 0x02:  # delete
            _stamp(data, header)
            data.extensions(header)
        case 0x03:  # query
            _consolidation(data, header)
            if header & 0x40:
                parameters = data.text()
            data.extensions(header)
        case 0x04:  # reply
            _consolidation(data, header)
            data.extensions(header)
            _body(data)
        case other:
            raise WireError(f"a body of unknown kind {other:#x}")
    return parameters


def _value(data: Cursor, header: int) -> None:
    _stamp(data, header)
    if header & 0x40 and data.number() & 1:  # an encoding, with a schema
        data.sized()
    data.extensions(header)
    data.sized()


def _stamp(data: Cursor, header: int) -> None:
    if header & 0x20:
        data.number()
        data.sized()


def _consolidation(data: Cursor, header: int) -> None:
    if header & 0x20:
        data.byte()


_READ: dict[int, Callable[[Cursor, int], Message | None]] = {
    0x1F: _out_of_band,
    0x1E: _declare,
    0x1D: _push,
    0x1C: _request,
    0x1B: _response,
    0x1A: _response_final,
    0x19: _interest,
}
