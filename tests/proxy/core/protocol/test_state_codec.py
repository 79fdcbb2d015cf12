"""States on the wire."""

import dataclasses
import zlib

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.protocol.bid import Segment
from proxy.core.protocol.envelope import VERSION, MalformedWireError
from proxy.core.protocol.fixed import seconds, ticks
from proxy.core.protocol.messages import State, StreamState
from proxy.core.protocol.split_report import SplitReport
from proxy.core.protocol.state_codec import pack_backlog, pack_state, unpack_backlog, unpack_state
from proxy.core.protocol.tuning import TUNING
from tests.proxy.core.protocol.drawn import amount, count, key, name, size, time, zid

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
bids = st.none() | st.just((Segment(1200, 130),))
reports = st.builds(SplitReport, st.integers(0, 2**32 - 1), bids, st.integers(1, 2**32 - 1), st.just(0))


@given(states, st.none() | reports, st.booleans())
def test_a_state_survives_the_wire(state, report, splits):
    """What was packed comes back; of an update its streams, its clock, its numbers and what it tells of parts alone."""
    state = dataclasses.replace(state, split=report, splits=splits and report is not None)
    assert unpack_state(pack_state(state), "r1") == state
    update = State("r1", state.zid, "", "", state.streams, (), state.wall_offset, number=state.number, since=1)
    update = dataclasses.replace(update, split=report, splits=state.splits)
    assert unpack_state(pack_state(dataclasses.replace(state, since=1)), "r1") == update


def test_a_period_longer_than_a_day_is_told_as_a_day():
    """What is so slow takes no part in any plan."""
    state = State("r1", "z1", "", "", (StreamState(1, "a", "x", 1e9),))
    assert unpack_state(pack_state(state), "r1").streams[0].period == pytest.approx(TUNING.period, rel=5e-4)


@given(st.binary(max_size=200), st.booleans())
def test_noise_is_malformed(data, compressed):
    """Random bytes never raise anything else, and never pass."""
    data = zlib.compress(data) if compressed else data
    with pytest.raises(MalformedWireError):
        unpack_state(data, "r1")


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


KEYS = st.lists(st.text(st.characters(exclude_categories=["Cs"], exclude_characters="*"), min_size=1, max_size=5))
"""Of no lone surrogates: keys come as UTF-8."""


@given(count, st.none() | KEYS.map(tuple))
def test_a_word_on_copies_that_wait_survives_the_wire(number, keys):
    """Without names, where there are too many, too."""
    assert unpack_backlog(pack_backlog(number, keys)) == (number, None if keys is None else frozenset(keys))


@pytest.mark.parametrize("fields", [[1], [-1, []], [1, "a"], [1, ["a/*"]], [1, [1]], ["1", None]])
def test_a_word_that_is_none_is_refused(fields):
    """Keys of samples are without wildcards."""
    with pytest.raises(MalformedWireError):
        unpack_backlog(msgpack.packb([VERSION, *fields]))


@given(st.binary(max_size=200), st.booleans())
def test_noise_is_no_backlog(data, compressed):
    """Random bytes never raise anything else, and never pass."""
    data = zlib.compress(data) if compressed else data
    with pytest.raises(MalformedWireError):
        unpack_backlog(data)
