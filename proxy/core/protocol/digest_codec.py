"""Digests on the wire; whatever does not fit is malformed and changes nothing.

They are small: times are whole ticks, mostly as distances, values 16 bits (`fixed.py`), records lists without the empty
end, and the sender's name and tag are in the key alone.
"""

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from proxy.core.protocol import checked, envelope
from proxy.core.protocol.envelope import MalformedWireError
from proxy.core.protocol.fixed import CODES, coded, seconds, ticks
from proxy.core.protocol.messages import Digest, Echo, State, StreamDigest
from proxy.core.protocol.split_report import SplitReport, read_report, report_fields
from proxy.core.protocol.tuning import TUNING

TELLS_WHETHER_ALL = 7
"""The version from which on digests say whether they tell of all."""


def pack_digest(digest: Digest) -> bytes:
    """Return the wire form of a digest."""
    sent = ticks(digest.sent)
    if digest.brief:
        return envelope.packed([sent, digest.state, [_brief_fields(sent, stream) for stream in digest.streams]])
    lists: list[list[Any]] = [
        [_stream_fields(sent, stream) for stream in digest.streams],
        [field for echo in digest.echoes for field in _echo_fields(sent, echo)],
        [coded(part) for part in digest.capacity],
        split_fields(digest),
    ]
    counts = [sent, digest.state, digest.messages, digest.bytes]
    if digest.partial:
        return envelope.packed([*counts, *lists, 1])
    while lists and not lists[-1]:
        lists.pop()
    return envelope.packed([*counts, *lists])


def unpack_digest(data: bytes, robot: str, tag: str, own: str = "", sent: Iterable[int] = ()) -> Digest:
    """Return the digest in `data` of `robot` with `tag`; raise `MalformedWireError` when it is none.

    Echoes are kept of those digests that we, `own`, did send: at one of the times `sent` [ticks].
    """
    fields = envelope.fields_of(data, TUNING.digest_bytes, 4)
    at, state = checked.time(fields[1]), checked.count(fields[2])
    if isinstance(fields[3], list):
        brief = [_brief_stream(at, each) for each in checked.entries(fields[3], 5, TUNING.entry_fields)]
        return Digest(robot, tag, seconds(at), streams=tuple(brief), state=state, brief=True)
    if len(fields) < 5:
        raise MalformedWireError(f"{len(fields)} fields where 5 are due")
    streams, echoes, capacity, split = [*map(checked.array, fields[5:9]), [], [], [], []][:4]
    splits, report = read_split(split)
    return Digest(
        robot=robot,
        tag=tag,
        sent=seconds(at),
        state=state,
        messages=checked.count(fields[3]),
        bytes=checked.count(fields[4]),
        streams=tuple(_stream(at, each) for each in checked.entries(streams, 7, 10 + TUNING.features)),
        echoes=_echoes(at, echoes, own, tuple(sent)),
        capacity=tuple(checked.amount(part, 1.0) for part in capacity),
        splits=splits,
        split=report,
        partial=_is_partial(fields, streams, split),
    )


def _is_partial(fields: list[Any], streams: list[Any], split: list[Any]) -> bool:
    """Whether a digest does not tell of all; version 6 did not say that, and told of parts alone now and then."""
    if fields[0] < TELLS_WHETHER_ALL:
        return bool(split) and not streams
    return any(checked.count(said, 1) for said in fields[9:10])


def digest_head(data: bytes) -> tuple[int, float]:
    """Return the version of a digest and when it was sent [s], cheaply; raise `MalformedWireError` when it is none."""
    version, sent = (*envelope.head(data, 2), None, None)[:2]
    return envelope.known_version(version), seconds(checked.time(sent))


def _count_fields(sent: int, s: StreamDigest) -> list[Any]:
    """The time of the last forwarded counts from that of the last generated; it need not be there."""
    generated = ticks(s.t_generated)
    forwarded = ticks(s.t_forwarded) - generated if s.forwarded else 0
    return [s.id, s.generated, max(0, s.generated - s.forwarded), sent - generated, forwarded]


def _rhythm_fields(s: StreamDigest, *, follows: bool) -> list[Any]:
    """Where there is no rhythm a 0 stands for it, if anything `follows`."""
    return [coded(min(s.period, TUNING.period)), s.late, s.jitter] if s.period else [0] * follows


def _stream_fields(sent: int, s: StreamDigest) -> list[Any]:
    rhythm = _rhythm_fields(s, follows=bool(s.features))
    return [*_count_fields(sent, s), s.size, coded(s.scale), *rhythm, *map(_feature_field, s.features)]


def _brief_fields(sent: int, s: StreamDigest) -> list[Any]:
    """Size and scale come last, for they may be as usual."""
    last = [s.size, *([] if s.scale < 0.0 else [coded(s.scale)])] if s.size or s.scale >= 0.0 else []
    return [*_count_fields(sent, s), *_rhythm_fields(s, follows=bool(last)), *last]


def _feature_field(number: float) -> int | float:
    return int(number) if number == math.floor(number) and abs(number) <= TUNING.count else number


def _stream(sent: int, f: list[Any]) -> StreamDigest:
    rhythm, features = _rhythm(f[7:])
    scale = checked.amount(f[6], TUNING.scale)
    return replace(_news(sent, f, f[5], scale), features=tuple(map(checked.number, features)), **rhythm)


def _brief_stream(sent: int, f: list[Any]) -> StreamDigest:
    rhythm, last = _rhythm(f[5:])
    scale = checked.amount(last[1], TUNING.scale) if len(last) > 1 else -1.0
    return replace(_news(sent, f, last[0] if last else 0, scale), **rhythm)


def _rhythm(f: list[Any]) -> tuple[dict[str, Any], list[Any]]:
    """Return the rhythm with which a list begins, if it is not a 0, and the rest of the list."""
    period = checked.amount(f[0], TUNING.period) if f else 0.0
    if not period:
        return {}, f[1:]
    if len(f) < 3:
        raise MalformedWireError("a period without a phase")
    late = max(-TUNING.phases, min(checked.time(f[1]), TUNING.phases))
    return {"period": period, "late": late, "jitter": min(checked.count(f[2]), TUNING.phases)}, f[3:]


def _news(sent: int, f: list[Any], size: object, scale: float) -> StreamDigest:
    """Return what the first five fields tell of a stream."""
    generated, unsent = checked.count(f[1], TUNING.samples), checked.count(f[2])
    age, forwarded = checked.time(f[3]), checked.time(f[4])
    if unsent > generated:
        raise MalformedWireError(f"{unsent} of {generated} samples were not sent")
    return StreamDigest(
        checked.count(f[0], 2**32),
        generated,
        generated - unsent,
        seconds(sent - age),
        seconds(sent - age + forwarded) if generated > unsent else 0.0,
        checked.count(size, TUNING.sample_bytes),
        scale,
    )


def split_fields(message: Digest | State) -> list[Any]:
    """Return as fields whether it is due that the team splits, and what is told of parts."""
    if message.split is None:
        return [1] if message.splits else []
    return [int(message.splits), *report_fields(message.split)]


def read_split(fields: list[Any]) -> tuple[bool, SplitReport | None]:
    """Return what such fields tell, of which none are as good as a 0."""
    splits, *report = fields or [0]
    try:
        return bool(checked.count(splits, 1)), read_report(report) if report else None
    except (ValueError, TypeError) as error:
        raise MalformedWireError(f"no report on parts: {error}") from error


def _echo_fields(sent: int, echo: Echo) -> list[Any]:
    """Of the time that is echoed only the last digits travel."""
    heard = sent - ticks(echo.received)
    times = _tag_field(echo.peer), ticks(echo.sent) % CODES, heard
    return [*times, echo.samples, coded(echo.latency), coded(echo.per_byte)]


def _tag_field(tag: str) -> int | str:
    """A tag of eight hexadecimal digits is a number."""
    try:
        number = int(tag, 16)
    except ValueError:
        return tag
    return number if f"{number:08x}" == tag else tag


def _echoes(sent: int, f: list[Any], own: str, ours: tuple[int, ...]) -> tuple[Echo, ...]:
    """Return the echoes in a digest: of ours where just one was sent at such a time; others tell how samples arrive."""
    echoes = []
    for record in checked.records(f, 6):
        peer, low = checked.tag(record[0]), checked.count(record[1], CODES)
        times = [t for t in ours if t % CODES == low] if peer == own else [0]
        if len(times) == 1:
            echoes.append(_echo(sent, peer, times[0], record))
    return tuple(echoes)


def _echo(sent: int, peer: str, echoed: int, f: list[Any]) -> Echo:
    received = seconds(sent - checked.time(f[2]))
    latency, per_byte = (checked.amount(each, TUNING.latency) for each in f[4:6])
    return Echo(peer, seconds(echoed), received, checked.count(f[3], TUNING.samples), latency, per_byte)
