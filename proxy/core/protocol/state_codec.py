"""States on the wire, compressed where that is shorter; whatever does not fit is malformed and changes nothing."""

import zlib
from dataclasses import replace
from typing import Any

from proxy.core.protocol import checked, envelope
from proxy.core.protocol.digest_codec import read_split, split_fields
from proxy.core.protocol.envelope import MalformedWireError
from proxy.core.protocol.fixed import coded, seconds, ticks
from proxy.core.protocol.messages import State, StreamState
from proxy.core.protocol.tuning import TUNING

_ZLIB = b"\x78"
"""What is compressed begins with this; no list in msgpack does."""

_UPDATE, _WHOLE = 6, 14
"""So many fields an update has, and a whole state, before what is told of parts."""


def pack_state(state: State) -> bytes:
    """Return the wire form of a state."""
    fields: list[Any] = [_zid_field(state.zid), state.number, state.since]
    fields += [[_stream_fields(stream) for stream in state.streams], ticks(state.wall_offset)]
    if not state.since:
        fields += [state.mode, state.specs, state.transport]
        fields += [list(state.subscriptions), [_zid_field(origin) for origin in state.origins]]
        fields += [ticks(state.clock_error), state.version, state.limits]
    if state.split is not None:
        fields.append(split_fields(state))
    plain = envelope.packed(fields)
    return min(plain, zlib.compress(plain, 9), key=len)


def stream_bytes(stream: StreamState) -> int:
    """Return what a stream takes in a state that is not compressed [B]."""
    return len(envelope.packed(_stream_fields(stream)))


def unpack_state(data: bytes, robot: str) -> State:
    """Return the state in `data` of `robot`; raise `MalformedWireError` when it is none."""
    f = envelope.fields_of(_inflated(data, TUNING.state_bytes + 1), TUNING.state_bytes, 6)
    zid, number, since, wall_offset = checked.zid(f[1]), checked.count(f[2]), checked.count(f[3]), checked.time(f[5])
    streams = tuple(map(_stream, checked.entries(checked.array(f[4], TUNING.streams), 3, TUNING.entry_fields)))
    if len({stream.id for stream in streams}) < len(streams):
        raise MalformedWireError("two streams of one number")
    place = _UPDATE if since else _WHOLE
    splits, report = read_split(checked.array(f[place]) if len(f) > place else [])
    if since:
        update = State(robot, zid, "", "", streams, wall_offset=seconds(wall_offset), number=number, since=since)
        return replace(update, splits=splits, split=report)
    if len(f) < 11:
        raise MalformedWireError(f"{len(f)} fields where 11 are due")
    return State(
        robot=robot,
        zid=zid,
        mode=checked.text(f[6]),
        specs=checked.text(f[7]),
        streams=streams,
        subscriptions=tuple(map(checked.text, checked.array(f[9], TUNING.subscriptions))),
        wall_offset=seconds(wall_offset),
        origins=tuple(map(checked.zid, checked.array(f[10], TUNING.origins))),
        transport=checked.text(f[8]),
        number=number,
        clock_error=_clock_error(f[11]) if len(f) > 11 else 0.0,
        version=checked.text(f[12])[: TUNING.version_text] if len(f) > 12 else "",
        limits=checked.count(f[13], 2**32) if len(f) > 13 else 0,
        splits=splits,
        split=report,
    )


def state_version(data: bytes) -> int:
    """Return the version of a state; raise `MalformedWireError` when it is none."""
    return envelope.known_version(*envelope.head(_inflated(data, TUNING.head_bytes), 1))


def _stream_fields(s: StreamState) -> list[Any]:
    rest = [coded(min(s.period, TUNING.period)), coded(min(s.jitter, TUNING.period)), s.size, s.schedule]
    while rest and not rest[-1]:
        rest.pop()
    return [s.id, s.key, s.information_type, *rest]


def _stream(f: list[Any]) -> StreamState:
    period, jitter, size, schedule = (f[3:] + [0, 0, 0, ""][len(f) - 3 :])[:4]
    return StreamState(
        id=checked.count(f[0], 2**32),
        key=checked.key(f[1]),
        information_type=checked.text(f[2]),
        period=checked.amount(period, TUNING.period),
        jitter=checked.amount(jitter, TUNING.period),
        size=checked.count(size, TUNING.sample_bytes),
        schedule=checked.text(schedule),
    )


def _clock_error(field: object) -> float:
    """More than the most is as good as nothing."""
    error = seconds(checked.count(field))
    return error if error <= TUNING.clock_error else 0.0


def _zid_field(zid: str) -> bytes | str:
    """An id is bytes in hexadecimal."""
    try:
        data = bytes.fromhex(zid)
    except ValueError:
        return zid
    return data if data and data.hex() == zid else zid


def _inflated(data: bytes, most: int) -> bytes:
    """Return at most `most` bytes of what was compressed."""
    if not data.startswith(_ZLIB):
        return data
    if len(data) > TUNING.state_bytes:
        raise MalformedWireError(f"{len(data)} bytes are more than the {TUNING.state_bytes} that a state may have")
    try:
        return zlib.decompressobj().decompress(data, most)
    except zlib.error as error:
        raise MalformedWireError(f"not compressed as a state is: {error}") from error


def pack_backlog(number: int, keys: tuple[str, ...] | None) -> bytes:
    """Return the message of that number on which keys copies wait; None: of too many to name."""
    return envelope.packed([number, keys])


def unpack_backlog(data: bytes) -> tuple[int, frozenset[str] | None]:
    """Return what `pack_backlog` was given; raise `MalformedWireError` when it is none."""
    number, keys = envelope.fields_of(data, TUNING.backlog_bytes, 3)[1:3]
    return checked.count(number), None if keys is None else frozenset(map(checked.key, checked.array(keys)))
