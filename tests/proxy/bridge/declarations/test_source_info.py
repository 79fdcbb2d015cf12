"""Replies get source info on the way out; all else leaves as it came. The bytes are those of Zenoh 1.10."""

from itertools import pairwise

import pytest
import zenoh
from hypothesis import given
from hypothesis import strategies as st

from proxy.bridge.declarations.cursor import Cursor
from proxy.bridge.declarations.source_info import SourceInfoInsertion, enclosed, encoded, new_mark, varint
from proxy.bridge.declarations.wire import Batches
from tests.proxy.bridge.declarations.test_wire import HANDSHAKE, batch, frame
from tests.proxy.nodes import plain_session

MARK = bytes(range(0xE0, 0xF0))
SOURCE = bytes.fromhex("f034717e46ab616e6f3bc87220fa2648fc06ac02")
"""Sample 300 of publisher 6 of the session fc4826fa2072c83b6f6e61ab467e7134."""
_RESPONSE = "fb020003712f78a10d4312f0ab2c23c7da90f438b3c28e3e882d562e07"

FULL = bytes.fromhex(
    f"780025d6838a69{_RESPONSE}04e1d8a9cdffb88df1806b1034717e46ab616e6f3bc87220fa2648fc09027a7a4330{MARK.hex()}"
    f"0000003014{SOURCE.hex()}01415454414348"
    "03504159"
)
"""A reply with a timestamp, an encoding with a schema, and the attachment `ATTACH`."""
FULL_SOURCED = bytes.fromhex(
    f"640025d6838a69{_RESPONSE}04e1d8a9cdffb88df1806b1034717e46ab616e6f3bc87220fa2648fc09027a7ac114{SOURCE.hex()}"
    "4306415454414348"
    "03504159"
)
TWO = bytes.fromhex(
    f"9f0025d7838a69{_RESPONSE}0481432a{MARK.hex()}0000002a14{SOURCE.hex()}0003504159"
    f"{_RESPONSE}0482422a{MARK.hex()}0000002a14{SOURCE.hex()}01"
)
"""A reply without attachment, and a delete with an empty one."""
TWO_SOURCED = bytes.fromhex(
    f"750025d7838a69{_RESPONSE}04814114{SOURCE.hex()}03504159{_RESPONSE}0482c114{SOURCE.hex()}4200"
)
END = bytes.fromhex("090025d8838a699a02210d")
"""There are no more replies."""


def cut(data, *places):
    """`data` in pieces."""
    return [data[i:j] for i, j in pairwise((0, *sorted(places), len(data)))]


def passed(pieces, mark=MARK):
    sourcing = SourceInfoInsertion(mark)
    return b"".join(map(sourcing.feed, pieces))


def test_replies_get_source_info_and_keep_their_attachments():
    """A put and a delete, with and without attachment, alone and together in a batch."""
    assert passed([FULL]).hex() == FULL_SOURCED.hex()
    assert passed([TWO]).hex() == TWO_SOURCED.hex()


@given(st.sets(st.integers(0, len(FULL + TWO + END))))
def test_it_does_not_matter_how_the_bytes_are_cut(places):
    """The same goes out, in whatever pieces it comes in."""
    assert passed(cut(FULL + TWO + END, *places)) == FULL_SOURCED + TWO_SOURCED + END


def test_the_first_fragment_of_a_reply_holds_all_that_changes():
    """What follows is copied, also where it looks the same: it is the end of an attachment that began before."""
    message = FULL[7:]
    first = batch(b"\xe6\x01\x02" + message + bytes(100))
    sourced = batch(b"\xe6\x01\x02" + FULL_SOURCED[7:] + bytes(100))
    later, torn = batch(b"\x66\x02" + message), batch(b"\xe6\x80")
    assert passed([first + later]) == sourced + later
    assert passed([torn + batch(b"\xe6" + MARK)]) == torn + batch(b"\xe6" + MARK)


@given(st.lists(st.binary(max_size=300)), st.data())
def test_batches_without_the_mark_leave_as_they_came(batches, data):
    """Whatever stands in them, and however they are cut."""
    whole = b"".join(map(batch, batches))
    places = data.draw(st.sets(st.integers(0, len(whole))))
    assert passed(cut(whole, *places), new_mark()) == whole


@given(st.binary(max_size=60), st.binary(max_size=60))
def test_a_mark_that_stands_elsewhere_is_copied(before, after):
    """No such bytes are written; should they be, they do no harm: nothing grows, and the next batch is intact."""
    strange = batch(before + MARK + after)
    out = passed([strange + FULL])
    assert out.endswith(FULL_SOURCED)
    size = int.from_bytes(out[:2], "little") + 2
    assert size + len(FULL_SOURCED) == len(out)
    assert size <= len(strange)


@pytest.mark.parametrize(
    "broken",
    [
        pytest.param(FULL.replace(b"\x43\x30" + MARK, b"\x44\x30" + MARK), id="another extension"),
        pytest.param(FULL.replace(b"\x30" + MARK, b"\x31" + MARK), id="another size"),
        pytest.param(batch(MARK), id="nothing else"),
        pytest.param(batch(b"\x25\x01\x43\x30" + MARK + b"\x00\x00\x00\x30\xff"), id="too short"),
    ],
)
def test_what_is_not_as_we_write_it_is_copied(broken):
    """As in another version of the protocol."""
    assert passed([broken]) == broken


@given(
    st.none() | st.binary(max_size=20_000),
    st.integers(1, 2**128 - 1),
    st.integers(0, 2**32 - 1),
    st.integers(0, 2**32 - 1),
    st.booleans(),
)
def test_any_attachment_and_source_are_unfolded(attachment, zid, eid, number, more):
    """As the protocol has them: two extensions, or one, and other extensions behind them stay."""
    source = bytes([(zid.bit_length() + 7) // 8 - 1 << 4]) + zid.to_bytes((zid.bit_length() + 7) // 8, "little")
    source += varint(eid) + varint(number)
    given = enclosed_as(source, attachment)
    header, behind = (b"\xc3", b"\x02") if more else (b"\x43", b"")
    put = b"\x3d\x00\x03abc\x81" + header + varint(len(given)) + given + behind + b"\x03PAY"
    out = passed([frame(put)])
    assert list(Batches().feed(out)) == []
    data = Cursor(out[out.index(b"abc") + 3 :])
    found = data.extensions(data.byte())
    assert found.pop(0x1) == source
    assert found.pop(0x3, None) == attachment
    assert bool(found) == more
    assert data.sized() == b"PAY"


def enclosed_as(source, attachment):
    """What `enclosed` makes, for source info that no session could have."""
    rest = b"\x00" if attachment is None else b"\x01" + attachment
    size = len(MARK) + 5 + len(source) + len(rest)
    return MARK + size.to_bytes(4, "big") + bytes([len(source)]) + source + rest


def test_source_info_is_written_as_zenoh_does():
    """The id of the session without its leading zeros, then the numbers."""
    with plain_session("peer") as session:
        publisher = session.declare_publisher("a")
        info = zenoh.SourceInfo(publisher.id, 300)
        found = Cursor(encoded(info))
        size = (found.byte() >> 4) + 1
        assert format(int.from_bytes(found.take(size), "little"), "x") == str(session.zid())
        assert (found.number(), found.number(), bool(found)) == (publisher.id.eid, 300, False)
        for attachment in (None, b"", b"more"):
            assert enclosed(MARK, info, attachment) == enclosed_as(encoded(info), attachment)


def test_marks_differ():
    """Nobody knows that of another."""
    assert len({new_mark() for _ in range(100)}) == 100


def test_the_handshake_passes():
    """Other batches are none of its business."""
    assert passed([bytes.fromhex(HANDSHAKE)]) == bytes.fromhex(HANDSHAKE)
