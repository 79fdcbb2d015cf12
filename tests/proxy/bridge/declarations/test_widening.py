"""Interests in our own key leave as interests in everything; all else leaves as it came."""

import pytest

from proxy.bridge.declarations.widening import EVERYTHING, InterestWidening
from proxy.bridge.declarations.wire import Batches, Declared, Interest
from tests.proxy.bridge.declarations.test_table import numbered
from tests.proxy.bridge.declarations.test_wire import HANDSHAKE, TOKEN, batch, frame

FIRST = bytes.fromhex("2a00a5a3bbd17831009e2108200200164073656e64776f727468792f65766572797468696e67f90753022108")
"""A number for our key, and an interest in subscribers there, as Zenoh 1.10 writes them."""
SECOND = bytes.fromhex("0d00a5a4bbd1783100f90855022108")
"""An interest in queryables there."""


def test_interests_in_our_key_lose_it():
    """The length of the batch follows, all else stays."""
    widening = InterestWidening(2)
    assert widening.feed(FIRST).hex() == FIRST.hex().replace("2a00", "2900", 1).replace("f9075302", "f90703")
    assert widening.feed(SECOND).hex() == "0c00a5a4bbd1783100f908052108"


@pytest.mark.parametrize("size", [1, 3, 1000])
def test_it_does_not_matter_how_the_bytes_are_cut(size):
    """The same goes out, in whatever pieces it comes in."""
    whole = bytes.fromhex(HANDSHAKE) + FIRST + SECOND + frame(TOKEN)
    widening = InterestWidening(2)
    out = b"".join(widening.feed(whole[i : i + size]) for i in range(0, len(whole), size))
    assert out == InterestWidening(2).feed(whole)
    assert list(Batches().feed(out[len(out) - len(frame(TOKEN)) :]))[-1] == Declared(
        "token", 7, 0, "tok", senders=False, complete=False
    )


def test_an_interest_that_spells_the_key_out_is_widened_too():
    """With a suffix instead of a number."""
    key = EVERYTHING.encode()
    spelled = frame(b"\x79\x01\x32\x00" + bytes([len(key)]) + key, TOKEN)
    out = InterestWidening(1).feed(spelled)
    assert out == frame(b"\x79\x01\x02", TOKEN)


def test_other_interests_and_those_after_the_last_are_left_alone():
    """Only so many as were announced, and only in our key."""
    other = frame(numbered(2, "apps/key"), b"\xf9\x07\x53\x02\x21\x08")
    widening = InterestWidening(1)
    assert widening.feed(other) == other
    assert widening.feed(FIRST) != FIRST
    assert widening.feed(FIRST) == FIRST
    assert widening.feed(FIRST[:5]) == FIRST[:5]
    assert any(isinstance(message, Interest) for message in Batches().feed(FIRST))


def test_what_is_not_understood_passes_unchanged():
    """Bytes of another protocol go through."""
    strange = batch(b"\x0a\x0b\x0c") + frame(b"\x0a")
    assert InterestWidening(1).feed(strange) == strange
