"""Random TOML documents of which it is known what is written on which line."""

import json
import re
from collections.abc import Callable

from hypothesis import strategies as st

from utility_specs.toml_lines import KeyPath

_WORDS = st.one_of(
    st.text("abcXYZ019_-", min_size=1, max_size=5),
    st.text(st.characters(max_codepoint=0xFFFF, exclude_categories=["Cs", "Cc"]), max_size=5),
    st.sampled_from(['"', "'", "#", "=", "a.b", "[x]", "\\", "\n", "{", "true", "1.5", "]]"]),
)
_SCALARS = st.sampled_from(
    [
        "1",
        "-1.5e3",
        "true",
        "inf",
        "0x1F",
        "1979-05-27 07:32:00",
        "07:32:00",
        '""',
        "''",
        '"# = [\\"]"',
        "'\\#]}'",
    ]
)
_MULTILINE = st.sampled_from(
    [
        '"""\na = 1\n[b]\n"""',
        "'''\n[[c]]\n'''",
        '"""""a"" \\" \\\n # x""""',
        "''''a'\n''b'''''",
        '""""""',
        "''''''",
    ]
)
_GAPS = st.sampled_from(["", " ", "\t", "\n", "\n  # a comment = [\n", " # ]\n\n"])
_BETWEEN = st.sampled_from(["", "\n", "# x = 1\n", "  \t\n# [y]\n\n"])


class _Writer:
    """Writes a document and notes the lines of its keys."""

    def __init__(self, draw: Callable) -> None:
        self.draw = draw
        self.text = ""
        self.lines: dict[KeyPath, int] = {}

    def keys(self, most: int) -> list[str]:
        return self.draw(st.lists(_WORDS, unique=True, max_size=most))

    def note(self, path: KeyPath) -> None:
        self.lines.setdefault(path, self.text.count("\n") + 1)

    def key(self, word: str) -> None:
        forms = [json.dumps(word), json.dumps(word, ensure_ascii=False)]
        forms += [f"'{word}'"] if not re.search(r"['\n]", word) else []
        forms += [word] * 3 if re.fullmatch(r"[A-Za-z0-9_-]+", word) else []
        self.text += self.draw(st.sampled_from(forms))

    def dotted(self, table: KeyPath, words: list[str]) -> KeyPath:
        for i, word in enumerate(words):
            self.text += self.draw(st.sampled_from([".", " . "])) if i else ""
            table = (*table, word)
            self.note(table)
            self.key(word)
        return table

    def assign(self, table: KeyPath, first: str, depth: int = 0) -> None:
        path = self.dotted(table, [first, *self.keys(1)])
        self.text += self.draw(st.sampled_from(["=", " = "]))
        self.value(path, depth)

    def value(self, path: KeyPath, depth: int) -> None:
        kinds = ["scalar", "scalar", "multiline", "array", "table"] if depth < 3 else ["scalar"]
        kind = self.draw(st.sampled_from(kinds))
        if kind == "array":
            self.array(path, depth)
        elif kind == "table":
            self.inline_table(path, depth)
        else:
            self.text += self.draw(_SCALARS if kind == "scalar" else _MULTILINE)

    def array(self, path: KeyPath, depth: int) -> None:
        size = self.draw(st.integers(0, 3))
        self.text += "["
        for index in range(size):
            self.text += self.draw(_GAPS)
            self.note((*path, index))
            self.value((*path, index), depth + 1)
            self.text += self.draw(_GAPS) + ("," if index < size - 1 else self.draw(st.sampled_from(["", ","])))
        self.text += self.draw(_GAPS) + "]"

    def inline_table(self, path: KeyPath, depth: int) -> None:
        self.text += "{ "
        for i, key in enumerate(self.keys(2)):
            self.text += ", " if i else ""
            self.assign(path, key, depth + 1)
        self.text += " }"

    def body(self, table: KeyPath, taken: frozenset[str] = frozenset()) -> None:
        for key in self.keys(3):
            if key not in taken:
                self.text += self.draw(_BETWEEN)
                self.assign(table, key)
                self.text += self.draw(st.sampled_from(["\n", "  # 'x\n"]))

    def header(self, brackets: str, table: KeyPath, words: list[str], *, shown: list[str]) -> KeyPath:
        self.text += self.draw(_BETWEEN) + brackets
        line = self.text.count("\n") + 1
        for i, word in enumerate(shown):
            self.text += "." if i else ""
            self.key(word)
        for word in words[:-1]:
            table = (*table, word)
            self.note(table)
        self.text += brackets.replace("[", "]") + "\n"
        if brackets == "[":
            self.lines[*table, words[-1]] = line
        return (*table, words[-1])


def _section(writer: _Writer, name: str) -> None:
    """Write a table, one that has its header after that of a table in it, or an array of tables."""
    inner = writer.draw(_WORDS)
    match writer.draw(st.sampled_from(["table", "implied", "array"])):
        case "table":
            writer.body(writer.header("[", (), [name], shown=[name]))
        case "implied":
            writer.body(writer.header("[", (), [name, inner], shown=[name, inner]))
            writer.body(writer.header("[", (), [name], shown=[name]), frozenset([inner]))
        case _:
            for index in range(writer.draw(st.integers(1, 3))):
                table = writer.header("[[", (), [name], shown=[name])
                writer.lines.setdefault(table, writer.text.count("\n"))
                writer.lines[*table, index] = writer.text.count("\n")
                writer.body((*table, index), frozenset([inner]))
                writer.body(writer.header("[", (*table, index), [inner], shown=[name, inner]))


@st.composite
def documents(draw: Callable) -> tuple[str, dict[KeyPath, int]]:
    """A valid document and the line of every key and array item in it."""
    writer = _Writer(draw)
    sections = writer.keys(3)
    writer.body((), frozenset(sections))
    for name in sections:
        _section(writer, name)
    text = writer.text.replace("\n", "\r\n") if draw(st.booleans()) else writer.text
    return text, writer.lines
