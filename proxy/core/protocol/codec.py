"""Digests and states as versioned msgpack; whatever does not fit is malformed and changes nothing.

A digest goes out several times a second at every robot, over the channel that it is there to save. So times are whole
ticks, most of them as the distance to another time, values are 16 bits (`fixed.py`), records are lists, what
is empty at the end is left out, and the sender's name and tag are in the key alone. A state is compressed.

The first field is the version. Daemons of neighbouring versions understand each other: a version may add fields at the
end of messages, and of what a state tells of a stream, which older daemons leave out and newer ones do without. What
others would misread is two versions on, so that they do not try, and the CHANGELOG says "wire version" and its number.
"""

import math
import zlib
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import msgpack

from proxy.core.protocol.errors import MalformedWireError, OtherVersionError
from proxy.core.protocol.fixed import coded, decoded, seconds, ticks
from proxy.core.protocol.messages import (
    MOST_CLOCK_ERROR,
    MOST_ORIGINS,
    MOST_SUBSCRIPTIONS,
    MOST_TOLD,
    Digest,
    Echo,
    State,
    StreamDigest,
    StreamState,
)
from proxy.core.protocol.parts import Told, fields, told_of

VERSION = 6
OLDEST = 6
"""What older daemons said is another language."""
READ = range(max(OLDEST, VERSION - 1), VERSION + 2)
"""The versions that are understood."""
MAX_DIGEST = 8192
"""Largest digest [B]."""
MAX_BYTES = 262_144
"""Largest state, before it is compressed [B]: of as many streams as a view holds, with keys of ordinary length."""
MAX_TIME = 1e10
MAX_COUNT = 2**53
MAX_SAMPLES = 2**40
"""A thousand samples a second for thirty years."""
MAX_SIZE = 2**30
"""Largest sample: that of Zenoh [B]."""
MAX_PERIOD = 86_400.0
"""A stream that is slower is told as this slow [s]."""
MOST_PHASES = 1_000_000
"""What is further off a rhythm is told as so far off."""
MAX_LATENCY = 3600.0
MAX_SCALE = 1e15
MAX_ENTRY = 32
"""Fields of what a state or an announcement tells of a stream; later versions may have more of them."""
MAX_BACKLOG = 131_072
"""Largest word on a backlog [B]."""
MAX_VERSION = 64
"""Letters in the version of a daemon."""
_HEAD = 32
"""The first two fields of a message take no more [B]."""
_WRAP = 65_536
_LARGEST = 3.5e38


def pack_digest(digest: Digest) -> bytes:
    """Return the wire form of a digest."""
    sent = ticks(digest.sent)
    if digest.brief:
        return _pack([VERSION, sent, digest.state, [_brief_fields(sent, stream) for stream in digest.streams]])
    whole: list[Any] = [VERSION, sent, digest.state, digest.messages, digest.bytes]
    lists: list[list[Any]] = [
        [_stream_fields(sent, stream) for stream in digest.streams],
        [field for e in digest.echoes for field in _echo_fields(sent, e)],
        [coded(part) for part in digest.capacity],
        _split_fields(digest),
    ]
    while lists and not lists[-1]:
        lists.pop()
    return _pack([*whole, *lists])


def unpack_digest(data: bytes, robot: str, tag: str, own: str = "", sent: Iterable[int] = ()) -> Digest:
    """Return the digest in `data` of `robot` with `tag`; raise `MalformedWireError` when it is none.

    Echoes are kept of those digests that we, `own`, did send: at one of the times `sent` [ticks].
    """
    return _digest(_fields(data, MAX_DIGEST, 4), robot, tag, own, sent)


def pack_state(state: State) -> bytes:
    """Return the wire form of a state."""
    fields: list[Any] = [
        *(VERSION, _packed_id(state.zid), state.number, state.since),
        [_stream_state_fields(stream) for stream in state.streams],
        ticks(state.wall_offset),
    ]
    if not state.since:
        fields += [state.mode, state.specs, state.transport]
        fields += [list(state.subscriptions), [_packed_id(origin) for origin in state.origins]]
        fields += [ticks(state.clock_error), state.version, state.limits]
    packed = _pack(fields)
    return min(packed, zlib.compress(packed, 9), key=len)


def unpack_state(data: bytes, robot: str) -> State:
    """Return the state in `data` of `robot`; raise `MalformedWireError` when it is none."""
    return _state(_fields(_inflated(data), MAX_BYTES, 6), robot)


def pack_backlog(number: int, keys: tuple[str, ...] | None) -> bytes:
    """Return the wire form of the word with that number on which keys copies wait; None: of too many to name."""
    return _pack([VERSION, number, keys])


def unpack_backlog(data: bytes) -> tuple[int, frozenset[str] | None]:
    """Return what `pack_backlog` was given; raise `MalformedWireError` when it is none."""
    number, keys = _fields(data, MAX_BACKLOG, 3)[1:3]
    return _count(number), None if keys is None else frozenset(map(_key, _list(keys)))


def digest_head(data: bytes) -> tuple[int, float]:
    """Return the version of a digest and when it was sent [s], which costs little.

    Raises `MalformedWireError` when it is none.
    """
    version, sent = (*_head(data, 2), None, None)[:2]
    return _known(version), seconds(_whole(sent))


def state_version(data: bytes) -> int:
    """Return the version of a state; raise `MalformedWireError` when it is none."""
    return _known(*_head(_inflated(data, _HEAD), 1))


def _stream_fields(sent: int, s: StreamDigest) -> list[Any]:
    """The time of the last forwarded counts from that of the last generated; neither it nor a rhythm need be there."""
    generated = ticks(s.t_generated)
    forwarded = ticks(s.t_forwarded) - generated if s.forwarded else 0
    unsent = max(0, s.generated - s.forwarded)
    told = [s.id, s.generated, unsent, sent - generated, forwarded, s.size, coded(s.scale)]
    return [*told, *(_rhythm_fields(s) or [0] * bool(s.features)), *map(_feature, s.features)]


def _brief_fields(sent: int, s: StreamDigest) -> list[Any]:
    """Size and scale come last, for they may be as usual."""
    told, rhythm = _stream_fields(sent, s)[:5], _rhythm_fields(s)
    last = [s.size, *([] if s.scale < 0.0 else [coded(s.scale)])] if s.size or s.scale >= 0.0 else []
    return [*told, *(rhythm or [0] * bool(last)), *last]


def _brief_digest(sent: int, f: list[Any]) -> StreamDigest:
    rhythm, last = (f[5:8], f[8:]) if len(f) > 5 and f[5] else (f[5:6], f[6:])
    size, scale = [*last, 0, 0][:2]
    news = _stream_digest(sent, [*f[:5], size, scale, *rhythm])
    return news if len(last) > 1 else replace(news, scale=-1.0)


def _rhythm_fields(s: StreamDigest) -> list[Any]:
    return [coded(min(s.period, MAX_PERIOD)), s.late, s.jitter] if s.period else []


def _stream_digest(sent: int, f: list[Any]) -> StreamDigest:
    generated, unsent, age, forwarded = _count(f[1], MAX_SAMPLES), _count(f[2]), _whole(f[3]), _whole(f[4])
    if unsent > generated:
        raise MalformedWireError(f"{unsent} of {generated} samples were not sent")
    period = _amount(f[7], MAX_PERIOD) if len(f) > 7 else 0.0
    rhythm, features = (f[8:10], f[10:]) if period else ([0, 0], f[8:])
    if len(rhythm) < 2:
        raise MalformedWireError("a period without a phase")
    return StreamDigest(
        _count(f[0], 2**32),
        generated,
        generated - unsent,
        seconds(sent - age),
        seconds(sent - age + forwarded) if generated > unsent else 0.0,
        _count(f[5], MAX_SIZE),
        _amount(f[6], MAX_SCALE),
        tuple(_number(value) for value in features),
        period,
        max(-MOST_PHASES, min(_whole(rhythm[0]), MOST_PHASES)),
        min(_count(rhythm[1]), MOST_PHASES),
    )


def _split_fields(digest: Digest) -> list[Any]:
    """Whether it is due, and what is told of parts."""
    if digest.split is None:
        return [1] if digest.splits else []
    return [int(digest.splits), *fields(digest.split)]


def _split(f: list[Any]) -> Told | None:
    if not f:
        return None
    try:
        return told_of(f)
    except (ValueError, TypeError) as error:
        raise MalformedWireError(f"nothing that is told of parts: {error}") from error


def _echo_fields(sent: int, e: Echo) -> tuple[Any, ...]:
    heard = sent - ticks(e.received)
    return _packed_tag(e.peer), ticks(e.sent) % _WRAP, heard, e.samples, coded(e.latency), coded(e.per_byte)


def _echoes(sent: int, f: list[Any], own: str, ours: Iterable[int]) -> tuple[Echo, ...]:
    """Of the time that is echoed only the last digits travel: one of those at which we did send must have them.

    Echoes of others tell how their samples arrive; when they sent is not known here.
    """
    ours, echoes = tuple(ours), []
    for record in _records(f, 6):
        peer, low = _tag(record[0]), _count(record[1], _WRAP)
        times = _ending(ours, low) if peer == own else [0]
        if len(times) == 1:
            echoes.append(_echo(sent, peer, times[0], record))
    return tuple(echoes)


def _ending(times: Iterable[int], low: int) -> list[int]:
    return [t for t in times if t % _WRAP == low]


def _echo(sent: int, peer: str, echoed: int, r: tuple[Any, ...]) -> Echo:
    received = seconds(sent - _whole(r[2]))
    latency, per_byte = _amount(r[4], MAX_LATENCY), _amount(r[5], MAX_LATENCY)
    return Echo(peer, seconds(echoed), received, _count(r[3], MAX_SAMPLES), latency, per_byte)


def _digest(f: list[Any], robot: str, tag: str, own: str, ours: Iterable[int]) -> Digest:
    sent = _whole(f[1])
    if isinstance(f[3], list):
        brief = tuple(_brief_digest(sent, stream) for stream in _each(f[3], 5, MAX_ENTRY))
        return Digest(robot, tag, seconds(sent), streams=brief, state=_count(f[2]), brief=True)
    if len(f) < 5:
        raise MalformedWireError(f"{len(f)} fields where 5 are due")
    streams, echoes, capacity, splits = [*map(_list, f[5:9]), [], [], [], []][:4]
    return Digest(
        robot=robot,
        tag=tag,
        sent=seconds(sent),
        state=_count(f[2]),
        messages=_count(f[3]),
        bytes=_count(f[4]),
        streams=tuple(_stream_digest(sent, stream) for stream in _each(streams, 7, 10 + 32)),
        echoes=_echoes(sent, echoes, own, ours),
        capacity=tuple(_amount(part, 1.0) for part in capacity),
        splits=bool(splits and _count(splits[0], 1)),
        split=_split(splits[1:]),
    )


def _state(f: list[Any], robot: str) -> State:
    zid, number, since = _id(f[1]), _count(f[2]), _count(f[3])
    streams = tuple(_stream_state(stream) for stream in _each(_at_most(f[4], MOST_TOLD), 3, MAX_ENTRY))
    if len({stream.id for stream in streams}) < len(streams):
        raise MalformedWireError("two streams of one number")
    if since:
        return State(robot, zid, "", "", streams, (), seconds(_whole(f[5])), number=number, since=since)
    if len(f) < 11:
        raise MalformedWireError(f"{len(f)} fields where 11 are due")
    return State(
        robot=robot,
        zid=zid,
        mode=_name(f[6]),
        specs=_name(f[7]),
        streams=streams,
        subscriptions=tuple(_name(key) for key in _at_most(f[9], MOST_SUBSCRIPTIONS)),
        wall_offset=seconds(_whole(f[5])),
        origins=tuple(_id(origin) for origin in _at_most(f[10], MOST_ORIGINS)),
        transport=_name(f[8]),
        number=number,
        clock_error=_clock_error(f[11:12]),
        version=_name(f[12])[:MAX_VERSION] if len(f) > 12 else "",
        limits=_count(f[13], 2**32) if len(f) > 13 else 0,
    )


def _clock_error(f: list[Any]) -> float:
    """Older versions do not tell it; more than the most is as good as nothing."""
    error = seconds(_count(f[0])) if f else 0.0
    return error if error <= MOST_CLOCK_ERROR else 0.0


def _stream_state_fields(s: StreamState) -> list[Any]:
    rest = [coded(min(s.period, MAX_PERIOD)), coded(min(s.jitter, MAX_PERIOD)), s.size, s.schedule]
    while rest and not rest[-1]:
        rest.pop()
    return [s.id, s.key, s.information_type, *rest]


def _stream_state(f: list[Any]) -> StreamState:
    period, jitter, size, schedule = (f[3:] + [0, 0, 0, ""][len(f) - 3 :])[:4]
    return StreamState(
        id=_count(f[0], 2**32),
        key=_key(f[1]),
        information_type=_name(f[2]),
        period=_amount(period, MAX_PERIOD),
        jitter=_amount(jitter, MAX_PERIOD),
        size=_count(size, MAX_SIZE),
        schedule=_name(schedule),
    )


def _pack(fields: list[Any]) -> bytes:
    packed: bytes = msgpack.packb(fields, use_single_float=True)
    return packed


def _inflated(data: bytes, most: int = MAX_BYTES + 1) -> bytes:
    """What was compressed, as far as a state may go, or `most` bytes of it."""
    if not data.startswith(b"\x78"):
        return data
    if len(data) > MAX_BYTES:
        raise MalformedWireError(f"{len(data)} bytes are more than the {MAX_BYTES} that a state may have")
    try:
        return zlib.decompressobj().decompress(data, most)
    except zlib.error as error:
        raise MalformedWireError(f"not compressed as a state is: {error}") from error


def _fields(data: bytes, most: int, least: int) -> list[Any]:
    """The fields of a message of at most so many bytes; bounded work whatever it is."""
    if len(data) > most:
        raise MalformedWireError(f"{len(data)} bytes are more than the {most} that a message may have")
    _known(*_head(data, 1))
    try:
        fields = msgpack.unpackb(data, max_array_len=MAX_DIGEST, max_map_len=0, max_str_len=1024, max_bin_len=32)
    except (ValueError, msgpack.UnpackException, RecursionError) as error:
        raise MalformedWireError(f"no msgpack: {error}") from error
    if len(fields) < least:
        raise MalformedWireError(f"{len(fields)} fields where {least} are due")
    return list(fields)


def _head(data: bytes, count: int) -> list[object]:
    """The first so many fields of a message, without looking at the rest."""
    unpacker = msgpack.Unpacker(max_buffer_size=_HEAD)
    unpacker.feed(data[:_HEAD])
    try:
        length = unpacker.read_array_header()
        return [unpacker.unpack() for _ in range(min(count, length))]
    except (ValueError, msgpack.UnpackException, RecursionError) as error:
        raise MalformedWireError(f"no msgpack: {error}") from error


def _known(version: object = None) -> int:
    """Let versions pass that are read here."""
    if type(version) is not int or version < 0:
        raise MalformedWireError(f"{version!r:.80} is no version")
    if version not in READ:
        raise OtherVersionError(version)
    return version


def _each(items: list[Any], least: int, most: int) -> list[list[Any]]:
    if not all(isinstance(item, list) and least <= len(item) <= most for item in items):
        raise MalformedWireError(f"an entry that is no list of {least} to {most}")
    return items


def _records(items: list[Any], length: int) -> list[tuple[Any, ...]]:
    if len(items) % length:
        raise MalformedWireError(f"{len(items)} fields of records of {length}")
    return [tuple(items[i : i + length]) for i in range(0, len(items), length)]


def _at_most(value: object, most: int) -> list[Any]:
    items = _list(value)
    if len(items) > most:
        raise MalformedWireError(f"{len(items)} entries are more than {most}")
    return items


def _list(value: object) -> list[Any]:
    if not isinstance(value, list):
        raise MalformedWireError(f"{value!r:.80} is no list")
    return value


def _name(value: object) -> str:
    if not isinstance(value, str):
        raise MalformedWireError(f"{value!r:.80} is no string")
    return value


def _key(value: object) -> str:
    key = _name(value)
    if "*" in key or not key:
        raise MalformedWireError(f"{key:.80} is no key of a sample")
    return key


def _packed_tag(tag: str) -> int | str:
    """A tag of eight hexadecimal digits is a number."""
    try:
        number = int(tag, 16)
    except ValueError:
        return tag
    return number if f"{number:08x}" == tag else tag


def _tag(value: object) -> str:
    if isinstance(value, str):
        return value
    return f"{_count(value, 2**32):08x}"


def _packed_id(zid: str) -> bytes | str:
    """An id is bytes in hexadecimal."""
    try:
        packed = bytes.fromhex(zid)
    except ValueError:
        return zid
    return packed if packed and packed.hex() == zid else zid


def _id(value: object) -> str:
    return value.hex() if isinstance(value, bytes) else _name(value)


def _count(value: object, most: int = MAX_COUNT) -> int:
    if type(value) is not int or not 0 <= value <= most:
        raise MalformedWireError(f"{value!r:.80} is no count")
    return value


def _whole(value: object) -> int:
    """A time in ticks."""
    if type(value) is not int or abs(value) > ticks(MAX_TIME):
        raise MalformedWireError(f"{value!r:.80} is no time")
    return value


def _feature(number: float) -> int | float:
    return int(number) if number == math.floor(number) and abs(number) <= MAX_COUNT else number


def _number(value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= _LARGEST:
        raise MalformedWireError(f"{value!r:.80} is no number")
    return float(value)


def _amount(value: object, most: float) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value < math.inf:
        raise MalformedWireError(f"{value!r:.80} is no amount")
    if isinstance(value, int) and value >= _WRAP:
        raise MalformedWireError(f"{value} is more than 16 bits")
    amount = decoded(value)
    if amount > most:
        raise MalformedWireError(f"{amount} is more than {most}")
    return amount
