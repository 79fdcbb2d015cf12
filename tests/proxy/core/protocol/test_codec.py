"""Digests and states on the wire."""

import dataclasses
import zlib

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.protocol.backlog_codec import pack_backlog, unpack_backlog
from proxy.core.protocol.bid import UNIT, Segment
from proxy.core.protocol.digest_codec import pack_digest, unpack_digest
from proxy.core.protocol.envelope import VERSION
from proxy.core.protocol.errors import MalformedWireError
from proxy.core.protocol.fixed import rounded, seconds, single, ticks
from proxy.core.protocol.messages import Digest, Echo, State, StreamDigest, StreamState
from proxy.core.protocol.split_report import TICK, SplitReport
from proxy.core.protocol.state_codec import pack_state, unpack_state
from proxy.core.protocol.tuning import TUNING

time = st.integers(0, 10**13).map(lambda ticks_: ticks_ / 1e4)
count = st.integers(0, 2**53)
samples = st.integers(0, TUNING.samples)
size = st.integers(0, TUNING.sample_bytes)
amount = st.floats(0.0, 3600.0).map(rounded)
period = st.floats(1e-4, 3600.0).map(rounded)
part = st.floats(0.0, 1.0).map(rounded)
feature = st.one_of(st.integers(-(2**53), 2**53).map(float), st.floats(-1e30, 1e30).map(single))
name = st.text(max_size=20)
tag = st.one_of(name, st.integers(0, 2**32 - 1).map(lambda n: f"{n:08x}"))
zid = st.one_of(name, st.binary(min_size=1, max_size=16).map(bytes.hex))
key = st.text(st.characters(exclude_characters="*", exclude_categories=["Cs"]), min_size=1, max_size=20)


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
stream_state = st.builds(StreamState, st.integers(0, 2**32), key, name, amount, amount, size, name)
states = st.builds(
    State,
    robot=st.just("r1"),
    zid=zid,
    mode=name,
    specs=name,
    streams=st.lists(stream_state, max_size=3, unique_by=lambda s: s.id).map(tuple),
    subscriptions=st.lists(name, max_size=3).map(tuple),
    wall_offset=time,
    origins=st.lists(zid, max_size=2).map(tuple),
    transport=name,
    number=count,
    clock_error=st.integers(0, ticks(TUNING.clock_error)).map(seconds),
    version=name,
    limits=st.integers(0, 2**32),
)


def heard(data, sent=()):
    return unpack_digest(data, "r1", "a1b2c3d4", "own", sent)


@given(st.one_of(digests, briefs))
def test_a_digest_survives_the_wire(digest):
    """What was packed comes back, once its values are rounded, times to the tenth of a millisecond."""
    assert heard(pack_digest(digest), [ticks(echo.sent) for echo in digest.echoes]) == digest


@given(states)
def test_a_state_survives_the_wire(state):
    """What was packed comes back; of an update its streams, its clock and its numbers alone."""
    assert unpack_state(pack_state(state), "r1") == state
    update = State("r1", state.zid, "", "", state.streams, (), state.wall_offset, number=state.number, since=1)
    assert unpack_state(pack_state(dataclasses.replace(state, since=1)), "r1") == update


@given(count, st.none() | st.lists(st.text(st.characters(exclude_characters="*"), min_size=1, max_size=5)).map(tuple))
def test_a_word_on_copies_that_wait_survives_the_wire(number, keys):
    """Without names, where there are too many, too."""
    assert unpack_backlog(pack_backlog(number, keys)) == (number, None if keys is None else frozenset(keys))


@pytest.mark.parametrize("fields", [[1], [-1, []], [1, "a"], [1, ["a/*"]], [1, [1]], ["1", None]])
def test_a_word_that_is_none_is_refused(fields):
    """Keys of samples are without wildcards."""
    with pytest.raises(MalformedWireError):
        unpack_backlog(msgpack.packb([VERSION, *fields]))


def test_echoes_are_those_of_our_digests():
    """Only the last digits of a time travel: what we did not send, or sent twice with them, is no echo."""
    echoes = (Echo("own", 77.0, 5.0, 1, 0.0), Echo("other", 77.0, 5.0, 1, 0.0))
    data = pack_digest(Digest("r1", "a1b2c3d4", 6.0, 0, 0, (), echoes))
    of_another = dataclasses.replace(echoes[1], sent=0.0)
    assert heard(data, [ticks(77.0), ticks(78.0)]).echoes == (echoes[0], of_another)
    assert heard(data, [ticks(78.0)]).echoes == (of_another,)
    assert heard(data, [ticks(77.0), ticks(77.0 + 6.5536)]).echoes == (of_another,)


def test_a_period_longer_than_a_day_is_told_as_a_day():
    """What is so slow takes no part in any plan."""
    state = State("r1", "z1", "", "", (StreamState(1, "a", "x", 1e9),))
    assert unpack_state(pack_state(state), "r1").streams[0].period == pytest.approx(TUNING.period, rel=5e-4)


@given(st.binary(max_size=200), st.booleans())
def test_noise_is_malformed(data, compressed):
    """Random bytes never raise anything else, and never pass."""
    data = zlib.compress(data) if compressed else data
    with pytest.raises(MalformedWireError):
        heard(data)
    with pytest.raises(MalformedWireError):
        unpack_state(data, "r1")
    with pytest.raises(MalformedWireError):
        unpack_backlog(data)


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


WHOLE = [VERSION, b"ab", 1, 0, [], 0, "enforce", "s", "unicast", [], []]


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (4, [[1, "k", "camera"], [1, "l", "camera"]]),
        (4, [[1, "k/*", "camera"]]),
        (4, [[1, "", "camera"]]),
        (4, [[1, "k", "camera", 10**9]]),
        (4, [[1, "k", "camera", 1e8]]),
        (4, [[n, "k", "x"] for n in range(5000)]),
        (4, [[1, "k" * 2000, "camera"]]),
        (9, ["k"] * 1025),
        (10, [b"z"] * 257),
        (10, [7]),
        (10, [b"z" * 33]),
        (11, -1),
        (11, 0.5),
        (3, -1),
    ],
)
def test_absurd_states_are_refused(place, value):
    """Streams without number, wildcards as keys, periods of years, more of anything than a robot has."""
    assert unpack_state(msgpack.packb(WHOLE), "r1").number == 1
    with pytest.raises(MalformedWireError):
        unpack_state(msgpack.packb([*WHOLE[:place], value, *WHOLE[place + 1 :]]), "r1")


def test_a_clock_that_may_be_wrong_by_more_than_is_of_use_is_not_known():
    """The rest of the state counts."""
    assert unpack_state(msgpack.packb([*WHOLE, ticks(TUNING.clock_error)]), "r1").clock_error == TUNING.clock_error
    told = unpack_state(msgpack.packb([*WHOLE, ticks(TUNING.clock_error) + 1]), "r1")
    assert (told.clock_error, told.number) == (0.0, 1)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (zlib.compress(b"\x00" * 100 * TUNING.state_bytes), "more than the"),
        (b"\x78" * (TUNING.state_bytes + 1), "more than the"),
        (b"\x78\x9c" + b"\xff" * 50, "not compressed"),
        (msgpack.packb(WHOLE[:8]), "8 fields where 11"),
    ],
)
def test_a_state_that_is_none_is_refused(data, message):
    """Bombs are not inflated further than a state may be large."""
    with pytest.raises(MalformedWireError, match=message):
        unpack_state(data, "r1")


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
