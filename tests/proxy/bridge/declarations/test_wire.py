"""Reading declarations out of the bytes of a link, here as a Zenoh 1.10 router wrote them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.bridge.declarations.cursor import WireError
from proxy.bridge.declarations.wire import Asked, Batches, Declared, Interest, KeyNumber, Undeclared

HANDSHAKE = (
    "5b00e109f06bf51b21f5ecfd75ad612b7be962c2920a00c03130628d292d8005e86da751a8fcf1d40b2bafe6179d07f05018272f5ef39"
    "6808f961105232640922fcb3f7d490eda01c98181c20ea58adfbfb2d386afea9ccffefb0f2701"
)
SUBSCRIBER = "1300a5c1d1e34231009e2108200200056170702f781000a5c2d1e34231009e2108620402022f2a"
QUERYABLES = "2e00a5c3d1e34231009e2108200300057372762f619e2108c4050321019e2108200400037372769e2108640604022f2a"
GONE = "1500a5c4d1e34231009e210803049e210885055f020000"
GONE_BY_NAME = "1200a5cc93e16431009e210885005f0401032f2a"


def read(*batches):
    return [declaration for batch in batches for declaration in Batches().feed(bytes.fromhex(batch))]


def test_the_handshake_declares_nothing():
    """Batches that set up the link are passed over."""
    assert read(HANDSHAKE) == []


def test_a_subscriber_is_declared_by_a_number_for_the_prefix_and_a_suffix():
    """`app/x/*` comes as number 2 for `app/x`, then scope 2 with the suffix `/*`."""
    assert read(SUBSCRIBER) == [
        KeyNumber(number=2, scope=0, suffix="app/x", senders=False),
        Declared("subscriber", number=4, scope=2, suffix="/*", senders=True, complete=False),
    ]


def test_queryables_say_whether_they_are_complete():
    """Completeness travels in an extension; several declarations share a frame."""
    declared = [declaration for declaration in read(QUERYABLES) if isinstance(declaration, Declared)]
    assert [(d.kind, d.number, d.complete) for d in declared] == [("queryable", 5, True), ("queryable", 6, False)]


def test_undeclarations_name_a_number_or_an_expression():
    """A router tells a client by number, another router by key expression."""
    by_number = read(GONE)
    assert [(d.kind, d.number, d.by_expression) for d in by_number] == [
        ("subscriber", 4, False),
        ("queryable", 5, False),
    ]
    (by_name,) = read(GONE_BY_NAME)
    assert by_name == Undeclared("queryable", number=0, scope=3, suffix="/*", senders=False)
    assert by_name.by_expression


@pytest.mark.parametrize("size", [1, 2, 3, 7, 1000])
def test_it_does_not_matter_how_the_bytes_are_cut(size):
    """A link delivers bytes in any pieces."""
    data = bytes.fromhex(HANDSHAKE + SUBSCRIBER + QUERYABLES + GONE)
    batches = Batches()
    pieces = [data[i : i + size] for i in range(0, len(data), size)]
    assert [d for piece in pieces for d in batches.feed(piece)] == read(HANDSHAKE, SUBSCRIBER, QUERYABLES, GONE)


def batch(payload):
    return len(payload).to_bytes(2, "little") + payload


def frame(*messages):
    return batch(b"\xa5\x01\x31\x00" + b"".join(messages))


TOKEN = bytes.fromhex("1e260700") + b"\x03tok"


ABC = "0003616263"
"""The key `abc`, without a number."""


@pytest.mark.parametrize(
    "message",
    [
        pytest.param("3d" + ABC + "01" + "03010203", id="put"),
        pytest.param("3d" + ABC + "e1" + "0101aa" + "030161" + "2105" + "0401020304", id="put with everything"),
        pytest.param("bd" + ABC + "a00f" + "c1021122" + "2105" + "01" + "00", id="put with extensions"),
        pytest.param("3d" + ABC + "02", id="delete"),
        pytest.param("3d" + ABC + "a2" + "0101aa" + "2105", id="delete with everything"),
        pytest.param("3c01" + ABC + "63" + "02" + "0561623d6364", id="query"),
        pytest.param("3c01" + ABC + "03", id="bare query"),
        pytest.param("3b01" + ABC + "24" + "00" + "01" + "020161", id="reply"),
        pytest.param("3b01" + ABC + "05" + "020161", id="error"),
        pytest.param("1a01", id="end of replies"),
        pytest.param("390102", id="interest in all subscribers"),
        pytest.param("790132" + ABC, id="interest in some subscribers"),
        pytest.param("1901", id="end of an interest"),
        pytest.param("5f01020102", id="out of band, bytes"),
        pytest.param("3f0107", id="out of band, number"),
        pytest.param("1e1a", id="end of declarations"),
        pytest.param("3e051a", id="end of declarations of an interest"),
        pytest.param("1e0105", id="key number given back"),
    ],
)
def test_all_other_messages_are_skipped_exactly(message):
    """Whatever stands before a declaration in a frame (puts, queries, replies, interests…), it is still found."""
    try:
        found = list(Batches().feed(frame(bytes.fromhex(message), TOKEN)))
    except WireError:
        pytest.fail(f"{message} is not skipped")
    assert found[-1:] == [Declared("token", 7, 0, "tok", senders=False, complete=False)]


def test_fragments_are_put_together():
    """A declaration cut over two fragments is read when the last one is there."""
    first, last = b"\x66\x01" + TOKEN[:3], b"\x26\x02" + TOKEN[3:]
    batches = Batches()
    found = [d for part in (first, last) for d in batches.feed(batch(part))]
    assert found == [Declared("token", 7, 0, "tok", senders=False, complete=False)]


def test_parts_of_messages_of_several_priorities_come_interleaved():
    """As where two applications send large queries. Each is put together by itself, reliable ones apart from others."""
    other = TOKEN[:-1] + b"x"
    parts = [
        (0xE6, 0x03, TOKEN[:3]),
        (0xE6, 0x05, other[:4]),
        (0xC6, 0x03, b"lost"),
        (0xA6, 0x03, TOKEN[3:]),
        (0xA6, 0x05, other[4:]),
    ]
    batches = Batches()
    found = [d for header, qos, part in parts for d in batches.feed(batch(bytes([header, 1, 0x21, qos]) + part))]
    assert [each.suffix for each in found] == ["tok", "tox"]


@pytest.mark.parametrize("mark", [0x02, 0x03], ids=["the next one begins", "a mark says so"])
def test_a_message_that_is_given_up_half_way_spoils_no_later_one(mark):
    """Where a link has no room for the rest of it."""
    parts = [b"\x66\x01lost", bytes([0xE6, 2, mark]) + TOKEN[:3] * (mark == 0x02)]
    parts += [] if mark == 0x02 else [b"\xe6\x03\x02" + TOKEN[:3]]
    batches = Batches()
    found = [d for part in (*parts, b"\x26\x04" + TOKEN[3:]) for d in batches.feed(batch(part))]
    assert [each.suffix for each in found] == ["tok"]


def test_a_keep_alive_may_precede_a_frame():
    """Keep-alives share batches with frames."""
    (declared,) = Batches().feed(batch(b"\x04" + frame(TOKEN)[2:]))
    assert declared.suffix == "tok"


@given(st.binary(max_size=200))
def test_any_bytes_are_read_or_refused(data):
    """Whatever stands in a batch, the reader ends: with declarations or with its own error."""
    try:
        list(Batches().feed(frame(data)))
        list(Batches().feed(batch(data)))
    except (WireError, UnicodeDecodeError):
        pass


QUERY = "2900a5e38b8e5d3104bc0103022f61a10cb40126b817e30107783d313b793d32c30509017a707045026161"


def test_a_query_says_how_it_is_asked():
    """To all, within 3 s, with a higher priority and waiting for room; payload and attachment do not matter."""
    (asked,) = read(QUERY)
    assert asked == Asked(3, "/a", senders=False, parameters="x=1;y=2", target=1, timeout=3.0, qos=0x0C)


def test_an_interest_says_where_it_stands():
    """So that whoever passes the batch on can alter it."""
    data = bytes.fromhex("790132" + ABC) + TOKEN
    (interest, _) = Batches().read(frame(data)[2:])
    assert (interest.scope, interest.suffix) == (0, "abc")
    told = frame(data)[2:]
    assert (told[interest.options], told[interest.end :]) == (0x32, TOKEN)


def test_an_interest_in_fragments_is_passed_over():
    """There it has no place in a batch."""
    data = bytes.fromhex("790132" + ABC) + TOKEN
    batches = Batches()
    found = [m for part in (b"\x66\x01" + data[:3], b"\x26\x02" + data[3:]) for m in batches.feed(batch(part))]
    assert not any(isinstance(message, Interest) for message in found)
    assert len(found) == 1


def test_frames_share_a_batch():
    """Messages that may get lost have a frame of their own behind the others."""
    found = list(Batches().feed(batch(frame(TOKEN)[2:] + frame(TOKEN)[2:])))
    assert len(found) == 2
