"""Finding the line on which a key is written."""

import tomllib

from hypothesis import given
from hypothesis import strategies as st

from tests.utility_specs.toml_documents import documents
from utility_specs.toml_lines import KeyPath, lines_of


def paths_in(value, path: KeyPath = ()) -> set[KeyPath]:
    """Return the paths of all that a parsed document holds."""
    items = value.items() if isinstance(value, dict) else enumerate(value if isinstance(value, list) else ())
    return {path} - {()} | {each for key, inner in items for each in paths_in(inner, (*path, key))}


@given(documents())
def test_every_key_is_found_on_the_line_where_it_is_written(document):
    """Whatever the syntax, each key and array item is located, and nothing else is."""
    text, expected = document
    assert set(expected) == paths_in(tomllib.loads(text))
    assert lines_of(text) == expected


@given(st.text(st.sampled_from("ab.=[]{},\"'\\#\n 1"), max_size=60))
def test_all_that_tomllib_accepts_is_located(text):
    """The scanner knows the same keys as the parser in any document that the parser accepts."""
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        return
    assert set(lines_of(text)) == paths_in(data)


def test_a_key_of_an_inline_table_within_a_repeated_table():
    """Nested structures count lines through comments, arrays and multi-line strings."""
    text = '# top\n[[type]]\nnote = """\n[x]\n"""\n[[type]]\nkeys = [\n  "a", # one\n  "b",\n]\n'
    text += "use = { kind = 1 }\n"
    lines = lines_of(text)
    assert lines["type",] == 2
    assert lines["type", 1] == 6
    assert lines["type", 1, "keys", 1] == 9
    assert lines["type", 1, "use", "kind"] == 11


def test_a_table_is_where_its_header_is_even_when_it_comes_late():
    """A header beats the mention of the table in an earlier, longer one."""
    assert lines_of("[a.b]\nx = 1\n[a]\ny = 2\n")["a",] == 3
