"""What nearly covers a key."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from utility_specs.near_keys import LONGEST, nearest

KEYS = ["robot/${robot:*}/camera", "robot/*/pose", "map/**"]


@pytest.mark.parametrize(
    ("key", "expression", "difference"),
    [
        ("robot/r1/camra", KEYS[0], '"camra" is not "camera"'),
        ("robots/r1/pose", KEYS[1], '"robots" is not "robot"'),
        ("robot/camera", KEYS[0], '"*" is missing'),
        ("robot/r1/left/camera", KEYS[0], '"left" is one chunk too many'),
        ("maps/3/4", KEYS[2], '"maps" is not "map"'),
    ],
)
def test_the_chunk_in_the_way_is_named(key, expression, difference):
    """The nearest expression comes first, as it is written."""
    near = nearest(key, KEYS, 3)[0]
    assert near.expression == expression
    assert near.differences == (difference,)


def test_what_is_further_off_is_not_told_beside_what_is_near():
    """One that is nearly right makes the others noise."""
    assert [each.expression for each in nearest("robot/r1/camra", KEYS, 3)] == [KEYS[0]]
    assert len(nearest("robot/r1/other", KEYS, 3)) == 2
    assert len(nearest("robot/r1/other", KEYS, 1)) == 1


def test_what_has_nothing_in_common_is_not_near():
    """Nothing is told rather than something that does not help."""
    assert nearest("a/b/c/d/e", KEYS, 3) == ()
    assert nearest("a", [], 3) == ()


def test_keys_of_very_many_chunks_are_not_compared():
    """Comparing takes the product of both lengths."""
    assert nearest("/".join(["robot"] * (LONGEST + 1)), KEYS, 3) == ()


chunks = st.lists(st.sampled_from(["robot", "r1", "camera", "pose", "x"]), min_size=1, max_size=5).map("/".join)


@given(chunks, st.lists(chunks, max_size=4))
def test_a_key_is_nearest_to_itself(key, others):
    """Whatever else there is, and nothing of it differs."""
    assert nearest(key, [*others, key], 3)[0].differences == ()
