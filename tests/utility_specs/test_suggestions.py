"""Hints for misspelt words."""

import pytest

from utility_specs.suggestions import described, hint, listed, quoted


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (True, "true"),
        (1, "1"),
        (-0.5, "-0.5"),
        (1.0, "1.0"),
        (1.0000001, "1.0000001"),
        (1e300, "1e+300"),
        (2**100, "a huge number"),
        ("a", '"a"'),
        ({"a": 1}, "a table"),
        ([1], "an array"),
        ((1,), "an array"),
    ],
)
def test_a_value_is_shown_as_its_writer_knows_it(value, shown):
    """Scalars look as in TOML, containers are named, nothing is endless."""
    assert described(value) == shown


def test_quotes_stay_on_one_line_and_short():
    """Control characters and long words cannot spoil a message."""
    assert quoted("a\nb\x1b") == '"a\ufffdb\ufffd"'
    assert quoted("x" * 41) == f'"{"x" * 39}…"'
    assert listed(["a", "b"]) == '"a", "b"'


def test_a_close_word_is_suggested_whatever_its_case():
    """The nearest known word is the hint."""
    assert hint("WIEGHT", ["weight", "window"]) == ' (did you mean "weight"?)'


def test_without_a_close_word_all_are_listed():
    """A reader who is far off sees the whole choice, if there is one."""
    assert hint("zzz", ["red", "blue"], "known keys") == ' (known keys: "red", "blue")'
    assert hint("zzz", []) == ""


def test_of_very_many_known_words_a_hint_lists_some():
    """And says how many more there are."""
    told = hint("zzz", [f"name{i}" for i in range(1000)])
    assert told.startswith(' (known: "name0", "name1", ')
    assert told.endswith('"name63" and 936 more)')
