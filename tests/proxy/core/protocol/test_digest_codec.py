"""Digests on the wire."""

import dataclasses
import zlib

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.protocol.bid import UNIT, Segment
from proxy.core.protocol.digest_codec import pack_digest, unpack_digest
from proxy.core.protocol.envelope import VERSION, MalformedWireError
from proxy.core.protocol.fixed import ticks
from proxy.core.protocol.messages import Digest, Echo, StreamDigest
from proxy.core.protocol.split_report import TICK, SplitReport
from proxy.core.protocol.tuning import TUNING
from tests.proxy.core.protocol.drawn import amount, count, feature, part, period, samples, size, time


@st.composite
def stream_digests(draw):
    """What was not sent has no time of sending, and no more was sent than generated."""
    generated, unsent = sorted((draw(samples), draw(samples)), reverse=True)
    forwarded = generated - unsent
    return StreamDigest(
        draw(st.integers(0, 2**32)),
        generated,
        forwarded,
        draw(time),
        draw(time) if forwarded else 0.0,
        draw(size),
        draw(amount),
        tuple(draw(st.lists(feature, max_size=3))),
        *draw(st.one_of(st.just(()), st.tuples(period, st.integers(-(10**6), 10**6), st.integers(0, 10**6)))),
    )


@st.composite
def announcements(draw):
    """What was sent of a stream; size and value only where they are not as usual, and no features."""
    value = draw(st.one_of(st.just(-1.0), amount))
    return dataclasses.replace(draw(stream_digests()), scale=value, features=())


segments = st.builds(Segment, st.integers(1, UNIT), st.integers(0, 255), st.sampled_from((0, 1, 2, 4)))
numbers = st.integers(0, 2**32 - 1)
tolds = st.builds(
    SplitReport,
    version=numbers,
    bid=st.one_of(st.none(), st.lists(segments, max_size=8).map(tuple)),
    table=st.integers(1, 2**32 - 1),
    agreed=numbers,
    turns=st.lists(numbers, min_size=1, max_size=5).map(tuple),
    unused=st.integers(0, 10**5).map(lambda ticks: ticks * TICK),
)
digests = st.builds(
    Digest,
    robot=st.just("r1"),
    tag=st.just("a1b2c3d4"),
    sent=time,
    messages=count,
    bytes=count,
    streams=st.lists(stream_digests(), max_size=2).map(tuple),
    echoes=st.lists(st.builds(Echo, st.just("own"), time, time, samples, amount, amount), max_size=1).map(tuple),
    state=count,
    capacity=st.lists(part, max_size=2).map(tuple),
    splits=st.booleans(),
    split=st.one_of(st.none(), tolds),
)
briefs = st.builds(
    Digest,
    robot=st.just("r1"),
    tag=st.just("a1b2c3d4"),
    sent=time,
    streams=st.lists(announcements(), max_size=3).map(tuple),
    state=count,
    brief=st.just(True),
)


def heard(data, sent=()):
    return unpack_digest(data, "r1", "a1b2c3d4", "own", sent)


@given(st.one_of(digests, briefs))
def test_a_digest_survives_the_wire(digest):
    """What was packed comes back, once its values are rounded, times to the tenth of a millisecond."""
    assert heard(pack_digest(digest), [ticks(echo.sent) for echo in digest.echoes]) == digest


def test_echoes_are_those_of_our_digests():
    """Only the last digits of a time travel: what we did not send, or sent twice with them, is no echo."""
    echoes = (Echo("own", 77.0, 5.0, 1, 0.0), Echo("other", 77.0, 5.0, 1, 0.0))
    data = pack_digest(Digest("r1", "a1b2c3d4", 6.0, 0, 0, (), echoes))
    of_another = dataclasses.replace(echoes[1], sent=0.0)
    assert heard(data, [ticks(77.0), ticks(78.0)]).echoes == (echoes[0], of_another)
    assert heard(data, [ticks(78.0)]).echoes == (of_another,)
    assert heard(data, [ticks(77.0), ticks(77.0 + 6.5536)]).echoes == (of_another,)


@given(st.binary(max_size=200), st.booleans())
def test_noise_is_malformed(data, compressed):
    """Random bytes never raise anything else, and never pass."""
    data = zlib.compress(data) if compressed else data
    with pytest.raises(MalformedWireError):
        heard(data)


NONSENSE = st.one_of(st.none(), st.text(max_size=3), st.integers(), st.floats(), st.lists(st.none()), st.booleans())


@given(st.one_of(digests, briefs), st.integers(0, 9), NONSENSE)
def test_a_field_of_another_kind_is_refused_or_harmless(digest, place, value):
    """Whatever stands in a field, the digest is refused or has fields of the right kinds."""
    fields = msgpack.unpackb(pack_digest(digest))
    fields[place:] = [value, *fields[place + 1 :]]
    try:
        packed = msgpack.packb(fields)
    except OverflowError:
        return
    try:
        read = heard(packed)
    except MalformedWireError:
        return
    for field in dataclasses.fields(Digest):
        # With a list in its third field it is an announcement, and such a one tells nothing of parts.
        kinds = {type(getattr(digest, field.name)), *([type(None)] if field.name == "split" and read.brief else ())}
        assert type(getattr(read, field.name)) in kinds


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"\x00" * (TUNING.digest_bytes + 1), "more than the"),
        (b"", "no msgpack"),
        (msgpack.packb({"a": 1}), "no msgpack"),
        (msgpack.packb([3, "r"]), "of version 3"),
        (msgpack.packb([6.0, "r"]), "is no version"),
        (msgpack.packb([VERSION, "r"]), "2 fields where 4 are due"),
        (b"\x91" * 5000, "no msgpack"),
        (msgpack.packb([VERSION, [0] * 8000]), "2 fields"),
    ],
)
def test_a_refusal_says_why(data, message):
    """Giant, truncated, foreign and nested data is refused with its reason."""
    with pytest.raises(MalformedWireError, match=message):
        heard(data)


BASE = [VERSION, 10_000, 1, 1, 1]
STREAM = [1, 5, 1, 10, 20, 300, 1]


@pytest.mark.parametrize(
    "fields",
    [
        [VERSION, 10**17, *BASE[2:]],
        [VERSION, 1, -1, *BASE[3:]],
        [VERSION, 1, True, *BASE[3:]],
        [*BASE[:4], 2**60],
        [*BASE, 5],
        [*BASE, [1]],
        [*BASE, [[1]]],
        [*BASE, [[*STREAM[:6], float("nan")]]],
        [*BASE, [[*STREAM[:6], float("inf")]]],
        [*BASE, [[*STREAM[:6], 1e30]]],
        [*BASE, [[*STREAM[:6], 65_536]]],
        [*BASE, [[*STREAM[:6], "1"]]],
        [*BASE, [[1, 2**50, *STREAM[2:]]]],
        [*BASE, [[1, 5, 6, *STREAM[3:]]]],
        [*BASE, [[*STREAM[:5], 2**60, 1]]],
        [*BASE, [[*STREAM, float("nan")]]],
        [*BASE, [[*STREAM, *range(40)]]],
        [*BASE, [], [1, 1, 1]],
        [*BASE, [], [], [1.5]],
        [*BASE, [], [], [], 1],
        [*BASE, [], [], [], [2]],
        [*BASE, [], [], [], [1, 1, 2**33, 1, 1]],
        [*BASE, [], [], [], [1, 1, 1, 1, -1]],
        [*BASE, [], [], [], [1, 1, 1, 1, 1, b"12"]],
        [*BASE, [], [], [], [1, 1, 1, 1, 1, None, *range(65)]],
        [*BASE[:3], [STREAM[:4]]],
        [*BASE[:3], [[*STREAM[:5], 0, 2**60]]],
        [*BASE[:3], [[*STREAM[:5], 0, 300, float("nan")]]],
        [*BASE[:3], [[1, 5, 6, *STREAM[3:]]]],
        [*BASE[:3], STREAM],
        [*BASE[:3], 5],
    ],
)
def test_absurd_digests_are_refused(fields):
    """Times of millennia, counts that no app reaches, sizes beyond Zenoh's, NaN: none of it reaches the view."""
    assert heard(msgpack.packb([*BASE, [STREAM]])).streams
    assert heard(msgpack.packb([*BASE[:3], [STREAM[:5]]])).brief
    with pytest.raises(MalformedWireError):
        heard(msgpack.packb(fields))


def test_digests_are_small():
    """Hours after their robots started."""
    streams = tuple(StreamDigest(n, 4000, 3000, 12345.6, 12344.5, 35_000, 3.3) for n in range(1, 6))
    echoes = tuple(Echo(f"b1b2c3d{n}", 5432.1, 12345.4, 5000, 0.0123, 8e-6) for n in range(9))
    base = Digest("robot-17", "a1b2c3d4", 12345.6789, 10_000, 10**9, state=7)

    def length(**news):
        return len(pack_digest(dataclasses.replace(base, **news)))

    assert length() == 16
    assert length(streams=streams[:1]) == 37
    assert length(streams=streams, echoes=echoes) <= 320
    usual = tuple(dataclasses.replace(stream, size=0, scale=-1.0) for stream in streams)
    assert length(streams=usual[:1], brief=True) == 23
    assert length(streams=usual, brief=True) <= 80
