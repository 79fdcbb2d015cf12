"""Key expressions that capture chunks; what is refused is among the broken specs."""

import re

import pytest
import zenoh
from hypothesis import given
from hypothesis import strategies as st

from utility_specs.key_formats import KeyFormat, as_text, values_of


@pytest.mark.parametrize(
    ("written", "expression", "key", "captured"),
    [
        ("robot/*/camera", "robot/*/camera", "robot/r1/camera", {}),
        ("robot/${robot:*}/camera", "robot/*/camera", "robot/r1/camera", {"robot": "r1"}),
        ("${a:*}/${b:*}", "*/*", "x/y", {"a": "x", "b": "y"}),
        ("robot/${robot:*}/**", "robot/*/**", "robot/r1/arm/camera", {"robot": "r1"}),
        ("**/${kind:*}/${n:*}", "*/*/**", "robot/r1/camera/3", {"kind": "camera", "n": "3"}),
        ("${robot:*}/**/${n:*}", "*/*/**", "r1/3", {"robot": "r1", "n": "3"}),
        ("robot/${cam:cam$*}", "robot/cam$*", "robot/cam7", {"cam": "cam7"}),
    ],
)
def test_chunks_are_captured_where_they_are_named(written, expression, key, captured):
    """From the front, or behind `**` from the back."""
    form = KeyFormat.parse(written)
    assert form.expression == expression
    assert zenoh.KeyExpr(expression).includes(key)
    assert form.captured(key) == captured


@pytest.mark.parametrize(
    ("chunk", "number"),
    [
        ("3", 3.0),
        ("-0.5", -0.5),
        ("1e3", 1000.0),
        ("007", 7.0),
        ("r1", None),
        ("nan", None),
        ("1_0", None),
        ("1e999", None),
    ],
)
def test_a_chunk_is_text_and_where_one_is_written_a_number(chunk, number):
    """Only what looks like a number in any language is one."""
    values = {as_text("n"): chunk}
    assert values_of({"n": chunk}) == (values if number is None else values | {"n": number})


CHUNKS = st.sampled_from(["a", "b1", "2"])


@given(st.lists(CHUNKS, min_size=1, max_size=5), st.lists(CHUNKS, max_size=3), st.lists(CHUNKS, max_size=3))
def test_every_key_that_is_included_gives_its_chunks_back(front, middle, back):
    """Whatever `**` stands for."""
    names = [f"c{i}" for i in range(len(front) + len(back))]
    holes = [f"${{{name}:*}}" for name in names]
    form = KeyFormat.parse("/".join([*holes[: len(front)], "**", *holes[len(front) :]]))
    key = "/".join([*front, *middle, *back])
    assert zenoh.KeyExpr(form.expression).includes(key)
    assert list(form.captured(key).values()) == [*front, *back]


@pytest.mark.parametrize(
    ("written", "says"), [("**/a/" * 4 + "b", "has more than 3 **"), ("x$*a$*b$*c$*", "has more than 3 $*")]
)
def test_what_takes_ages_to_compare_is_refused(written, says):
    """Three wildcards of unknown length are as many as a spec needs."""
    with pytest.raises(ValueError, match=re.escape(says)):
        KeyFormat.parse(written)
