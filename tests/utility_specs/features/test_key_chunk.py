"""Numbers in keys."""

import pytest
from pydantic import ValidationError

from utility_specs.features.key_chunk import KeyChunkTable
from utility_specs.features.sample import Sample


@pytest.mark.parametrize(("index", "number"), [(1, 7.0), (2, 12.0), (3, -3.0), (4, 1.5), (-1, 1000.0), (-5, 7.0)])
def test_the_number_in_a_chunk(index, number):
    """Alone, or the only one among letters; counted from either end."""
    feature = KeyChunkTable(kind="key_chunk", index=index).feature()
    assert feature.measure(Sample("robot/7/arm12/-3/v1.5b/1e3", b"")) == number
    assert not feature.reads_payload


@pytest.mark.parametrize(
    ("key", "index"),
    [("robot/a", 1), ("robot/3to4", 1), ("robot", 1), ("", 0), ("robot/²", 1), ("1_2", 0), ("٣", 0)],
)
def test_no_number_or_several(key, index):
    """The caller then takes the default."""
    with pytest.raises((ValueError, IndexError)):
        KeyChunkTable(kind="key_chunk", index=index).feature().measure(Sample(key, b""))


@pytest.mark.parametrize("index", [-65_536, 65_536, pytest.param(16**5000, id="huge")])
def test_no_key_has_so_many_chunks(index):
    """Numbers that nothing can write are refused like any other."""
    with pytest.raises(ValidationError, match="index"):
        KeyChunkTable(kind="key_chunk", index=index)
