"""Digests and states on the wire."""

import dataclasses

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.codec import MAX_BYTES, pack_digest, pack_state, unpack_digest, unpack_state
from proxy.core.errors import MalformedWireError
from proxy.core.wire import Digest, Echo, Grant, State, StreamDigest, StreamState

micro = st.integers(0, 10**15).map(lambda ticks: ticks / 1e6)
count = st.integers(0, 2**53)
single = st.floats(0.0, 2.0**100, width=32)
name = st.text(max_size=20)
digests = st.builds(
    Digest,
    robot=name,
    tag=name,
    sent=micro,
    epoch=count,
    messages=count,
    bytes=count,
    streams=st.tuples(
        st.builds(StreamDigest, count, count, count, micro, micro, count, single, st.tuples(single, single))
    ),
    grants=st.tuples(st.builds(Grant, name, count, st.integers(0, 2**50))),
    echoes=st.tuples(st.builds(Echo, name, micro, micro, count, micro, single)),
    state=count,
    capacity=st.tuples(single),
)
states = st.builds(
    State,
    robot=name,
    zid=name,
    mode=name,
    specs=name,
    streams=st.tuples(st.builds(StreamState, count, name, name, micro, micro, count, name)),
    subscriptions=st.tuples(name, name),
    wall_offset=micro,
    origins=st.tuples(name),
    transport=name,
    number=count,
)


@given(digests)
def test_a_digest_survives_the_wire(digest):
    """What was packed comes back, times to the microsecond."""
    assert unpack_digest(pack_digest(digest)) == digest


@given(states)
def test_a_state_survives_the_wire(state):
    """What was packed comes back."""
    assert unpack_state(pack_state(state)) == state


@given(st.binary(max_size=200))
def test_noise_is_malformed(data):
    """Random bytes never raise anything else, and never pass."""
    for unpack in (unpack_digest, unpack_state):
        with pytest.raises(MalformedWireError):
            unpack(data)


NONSENSE = st.one_of(st.none(), st.text(max_size=3), st.integers(), st.floats(), st.lists(st.none()))


@given(digests, st.integers(0, 11), NONSENSE)
def test_a_field_of_another_kind_is_refused_or_harmless(digest, place, value):
    """Whatever stands in a field, the digest is refused or has fields of the right kinds."""
    fields = msgpack.unpackb(pack_digest(digest))
    fields[place] = value
    try:
        packed = msgpack.packb(fields)
    except OverflowError:
        return
    try:
        read = unpack_digest(packed)
    except MalformedWireError:
        return
    for field in dataclasses.fields(Digest):
        assert type(getattr(read, field.name)) is type(getattr(digest, field.name))


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"\x00" * (MAX_BYTES + 1), "more than the"),
        (b"", "no msgpack"),
        (msgpack.packb({"a": 1}), "not version 2"),
        (msgpack.packb([1, "r"]), "not version 2"),
        (msgpack.packb([2, "r"]), "2 fields where 12 are due"),
        (b"\x91" * 5000, "no msgpack"),
    ],
)
def test_a_refusal_says_why(data, message):
    """Giant, truncated, foreign and nested data is refused with its reason."""
    with pytest.raises(MalformedWireError, match=message):
        unpack_digest(data)


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (3, 10**17),
        (4, -1),
        (4, True),
        (5, 2**60),
        (7, [[1]]),
        (7, 5),
        (1, 7),
        (7, [[1, 1, 1, 1, 1, 1, float("nan"), []]]),
        (11, [-1.0]),
    ],
)
def test_absurd_values_are_refused(place, value):
    """Times of millennia, negative counts, NaN: none of it reaches the view."""
    fields = msgpack.unpackb(pack_digest(Digest("r", "z", 1.0, 1, 1, 1)))
    fields[place] = value
    with pytest.raises(MalformedWireError):
        unpack_digest(msgpack.packb(fields))


def test_a_digest_is_small():
    """Robots tell each other of one stream and a grant in under 100 bytes, hours after they started."""
    digest = Digest(
        "r1",
        "a1b2c3d4",
        12345.678901,
        2**32 - 1,
        10_000,
        10**9,
        (StreamDigest(1, 40_000, 9_000, 12345.6, 12345.5, 35_000, 3.5),),
        (Grant("b1b2c3d4", 0, 35_000_000),),
    )
    assert len(pack_digest(digest)) < 100
