"""Digests and states as versioned msgpack; whatever does not fit is malformed and changes nothing.

Times travel as integer microseconds, most of them as the distance to the send time, scales as single-precision
floats, records as lists: a digest is sent several times a second by every robot, over the channel it is there to save.
"""

import math
from collections.abc import Callable
from typing import Any, TypeVar

import msgpack

from proxy.core.errors import MalformedWireError
from proxy.core.wire import Digest, Echo, Grant, State, StreamDigest, StreamState

VERSION = 2
MAX_BYTES = 262_144
"""A state of as many streams as a view holds fits, with keys of ordinary length."""
MAX_TIME = 1e10
MAX_COUNT = 2**53
T = TypeVar("T")


def pack_digest(digest: Digest) -> bytes:
    """Return the wire form of a digest."""
    sent = _ticks(digest.sent)
    return _pack(
        [
            VERSION,
            digest.robot,
            digest.tag,
            sent,
            digest.epoch,
            digest.messages,
            digest.bytes,
            [
                [
                    s.id,
                    s.generated,
                    s.forwarded,
                    sent - _ticks(s.t_generated),
                    sent - _ticks(s.t_forwarded),
                    s.size,
                    s.scale,
                    list(s.features),
                ]
                for s in digest.streams
            ],
            [[g.peer, _after(sent, g.begins), _after(sent, g.ends), list(g.parts)] for g in digest.grants],
            [
                [e.peer, _ticks(e.sent), sent - _ticks(e.received), e.samples, _ticks(e.latency), e.per_byte]
                for e in digest.echoes
            ],
            digest.state,
            list(digest.capacity),
        ]
    )


def unpack_digest(data: bytes) -> Digest:
    """Return the digest in `data`; raise `MalformedWireError` when it is none."""
    return _unpack(data, 12, _digest)


def pack_state(state: State) -> bytes:
    """Return the wire form of a state."""
    return _pack(
        [
            VERSION,
            state.robot,
            state.zid,
            state.mode,
            state.specs,
            [
                [s.id, s.key, s.information_type, _ticks(s.period), _ticks(s.jitter), s.size, s.schedule]
                for s in state.streams
            ],
            list(state.subscriptions),
            _ticks(state.wall_offset),
            list(state.origins),
            state.transport,
            state.number,
        ]
    )


def unpack_state(data: bytes) -> State:
    """Return the state in `data`; raise `MalformedWireError` when it is none."""
    return _unpack(data, 11, _state)


def _digest(f: list[Any]) -> Digest:
    sent = _time(f[3])
    return Digest(
        robot=_name(f[1]),
        tag=_name(f[2]),
        sent=sent,
        epoch=_count(f[4]),
        messages=_count(f[5]),
        bytes=_count(f[6]),
        state=_count(f[10]),
        capacity=tuple(_amount(part) for part in _list(f[11])),
        streams=_each(f[7], 8, lambda s: _stream_digest(f[3], s)),
        grants=_each(f[8], 4, lambda g: _grant(f[3], g)),
        echoes=_each(f[9], 6, lambda e: _echo(f[3], e)),
    )


def _stream_digest(sent: int, f: list[Any]) -> StreamDigest:
    return StreamDigest(
        _count(f[0]),
        _count(f[1]),
        _count(f[2]),
        _before(sent, f[3]),
        _before(sent, f[4]),
        _count(f[5]),
        _amount(f[6]),
        tuple(_number(value) for value in _list(f[7])),
    )


def _grant(sent: int, f: list[Any]) -> Grant:
    begins, ends = (sent // 1000 + round(_time(t) * 1e6) for t in f[1:3])
    return Grant(_name(f[0]), begins / 1e3, ends / 1e3, tuple(_count(part) for part in _list(f[3])))


def _after(sent: int, t: float) -> int:
    """A time in whole milliseconds that travels as its distance from the send time, which is short."""
    return round(t * 1e3) - sent // 1000


def _echo(sent: int, f: list[Any]) -> Echo:
    return Echo(_name(f[0]), _time(f[1]), _before(sent, f[2]), _count(f[3]), _time(f[4]), _amount(f[5]))


def _before(sent: int, f: object) -> float:
    """A time that travels as its distance to the send time, which is short."""
    return (sent - round(_time(f) * 1e6)) / 1e6


def _state(f: list[Any]) -> State:
    return State(
        robot=_name(f[1]),
        zid=_name(f[2]),
        mode=_name(f[3]),
        specs=_name(f[4]),
        streams=_each(f[5], 7, _stream_state),
        subscriptions=tuple(_name(key) for key in _list(f[6])),
        wall_offset=_time(f[7]),
        origins=tuple(_name(origin) for origin in _list(f[8])),
        transport=_name(f[9]),
        number=_count(f[10]),
    )


def _stream_state(f: list[Any]) -> StreamState:
    return StreamState(
        _count(f[0]), _name(f[1]), _name(f[2]), abs(_time(f[3])), abs(_time(f[4])), _count(f[5]), _name(f[6])
    )


def _pack(fields: list[Any]) -> bytes:
    packed: bytes = msgpack.packb(fields, use_single_float=True)
    return packed


def _unpack(data: bytes, length: int, build: Callable[[list[Any]], T]) -> T:
    if len(data) > MAX_BYTES:
        raise MalformedWireError(f"{len(data)} bytes are more than the {MAX_BYTES} that a message may have")
    try:
        fields = msgpack.unpackb(data, max_array_len=MAX_BYTES, max_str_len=1024)
    except (ValueError, msgpack.UnpackException, RecursionError) as error:
        raise MalformedWireError(f"no msgpack: {error}") from error
    if not isinstance(fields, list) or not fields or fields[0] != VERSION:
        raise MalformedWireError(f"not version {VERSION}")
    if len(fields) < length:
        raise MalformedWireError(f"{len(fields)} fields where {length} are due")
    return build(fields)


def _each(value: object, length: int, build: Callable[[list[Any]], T]) -> tuple[T, ...]:
    items = _list(value)
    if not all(isinstance(item, list) and len(item) >= length for item in items):
        raise MalformedWireError(f"an entry that is no list of {length}")
    return tuple(build(item) for item in items)


def _list(value: object) -> list[Any]:
    if not isinstance(value, list):
        raise MalformedWireError(f"{value!r} is no list")
    return value


def _name(value: object) -> str:
    if not isinstance(value, str):
        raise MalformedWireError(f"{value!r} is no string")
    return value


def _count(value: object) -> int:
    if type(value) is not int or not 0 <= value <= MAX_COUNT:
        raise MalformedWireError(f"{value!r} is no count")
    return value


def _time(value: object) -> float:
    if type(value) is not int or abs(value) > MAX_TIME * 1e6:
        raise MalformedWireError(f"{value!r} is no time")
    return value / 1e6


def _number(value: object) -> float:
    if type(value) is not float or not math.isfinite(value):
        raise MalformedWireError(f"{value!r} is no number")
    return value


def _amount(value: object) -> float:
    number = _number(value)
    if number < 0.0:
        raise MalformedWireError(f"{value!r} is no amount")
    return number


def _ticks(seconds: float) -> int:
    return round(seconds * 1e6)
