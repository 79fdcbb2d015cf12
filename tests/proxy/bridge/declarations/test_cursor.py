"""The pieces of messages."""

import pytest

from proxy.bridge.declarations.cursor import Cursor, WireError


@pytest.mark.parametrize(
    ("data", "value"), [("00", 0), ("7f", 127), ("8001", 128), ("b817", 3000), ("ffffffffffffffffff", 2**64 - 1)]
)
def test_integers_have_up_to_nine_bytes(data, value):
    """Seven bits a byte, the ninth has eight."""
    cursor = Cursor(bytes.fromhex(data))
    assert cursor.number() == value
    assert not cursor


def test_extensions_are_found_by_id():
    """Of each kind: none, an integer, bytes; the last one says that it is."""
    cursor = Cursor(bytes.fromhex("81" + "a405" + "43" + "02abcd"))
    assert cursor.extensions(0x80) == {1: 0, 4: 5, 3: b"\xab\xcd"}
    assert cursor.extensions(0x00) == {}


@pytest.mark.parametrize("data", ["", "80", "0301"])
def test_what_ends_early_is_refused(data):
    """No piece reads past the end."""
    with pytest.raises(WireError):
        Cursor(bytes.fromhex(data)).sized()


def test_an_expression_says_whose_number_it_uses():
    """Scope, suffix and the flags of the header."""
    assert Cursor(bytes.fromhex("03")).expression(0x00) == (3, "", False)
    assert Cursor(bytes.fromhex("00" + "0161")).expression(0x60) == (0, "a", True)


def test_it_knows_where_it_stands():
    """The place of a piece in its batch can be told."""
    cursor = Cursor(b"\x01\x02\x03")
    assert (cursor.byte(), cursor.at) == (1, 1)
    assert (cursor.rest(), cursor.at) == (b"\x02\x03", 3)
    with pytest.raises(WireError):
        cursor.byte()
