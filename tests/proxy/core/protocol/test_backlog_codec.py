"""What is said on copies that wait, on the wire."""

import zlib

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.protocol.envelope import VERSION, MalformedWireError
from proxy.core.protocol.state_codec import pack_backlog, unpack_backlog
from tests.proxy.core.protocol.drawn import count

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
def test_noise_is_malformed(data, compressed):
    """Random bytes never raise anything else, and never pass."""
    data = zlib.compress(data) if compressed else data
    with pytest.raises(MalformedWireError):
        unpack_backlog(data)
