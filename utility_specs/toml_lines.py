"""Where every key of a TOML document is written.

`tomllib` tells values but no places. This scanner goes over a document that `tomllib` has accepted, so it
need not check anything: it tells keys from values, and follows arrays, tables and strings to their ends.
"""

import ast
import re

KeyPath = tuple[str | int, ...]
"""The keys, and the indices of arrays, that lead from the root of a document to a value."""

_BASIC = r'"(?:[^"\\\n]|\\.)*+"'
_LITERAL = r"'[^'\n]*+'"
_BLANK = re.compile(r"(?:[ \t\n]|#[^\n]*+)*+")
_KEY_PART = re.compile(rf"[ \t]*+([A-Za-z0-9_-]++|{_BASIC}|{_LITERAL})[ \t]*+")
_SCALAR = re.compile(
    r'"""(?:[^"\\]|\\[\s\S]|"{1,2}(?!"))*+"{3,5}'
    r"|'''(?:[^']|'{1,2}(?!'))*+'{3,5}"
    rf"|{_BASIC}|{_LITERAL}"
    r"|[^,\]}#\n]++"  # numbers, booleans, dates (which may hold a space)
)


def lines_of(text: str) -> dict[KeyPath, int]:
    """Return the line, from 1, on which each key and each array item of a valid document is written.

    A table is where its header is; one that only longer keys imply is where the first of them is.
    """
    scanner = _Scanner(text)
    scanner.document()
    return scanner.lines


class _Scanner:
    """One pass over a document; `lines` fills up on the way."""

    def __init__(self, text: str) -> None:
        self._text = text.replace("\r\n", "\n")
        self._at = 0
        self._line = 1
        self._counted = 0
        self._items: dict[KeyPath, int] = {}
        self.lines: dict[KeyPath, int] = {}

    def document(self) -> None:
        """Scan headers and assignments to the end."""
        table: KeyPath = ()
        self._take(_BLANK)
        while self._at < len(self._text):
            if self._text.startswith("[", self._at):
                table = self._header()
            else:
                self._assignment(table)
            self._take(_BLANK)

    def _header(self) -> KeyPath:
        """Scan `[a.b]` or `[[a.b]]` and return the table that it opens."""
        opening = 2 if self._text.startswith("[[", self._at) else 1
        self._at += opening
        *parents, last = self._key()
        self._at += opening
        table: KeyPath = ()
        for part in parents:
            table = self._current((*table, part))
        table = (*table, last)
        if opening == 1:
            self.lines[table] = self._line_here()
            return table
        self._note(table)
        self._items[table] = self._items.get(table, -1) + 1
        self.lines[*table, self._items[table]] = self._line_here()
        return self._current(table, implied=False)

    def _current(self, table: KeyPath, *, implied: bool = True) -> KeyPath:
        """Return the table, or its newest item when it is an array of tables."""
        if implied:
            self._note(table)
        return (*table, self._items[table]) if table in self._items else table

    def _assignment(self, table: KeyPath) -> None:
        """Scan `a.b = value` within a table."""
        *parents, last = self._key()
        for part in parents:
            table = (*table, part)
            self._note(table)
        path = (*table, last)
        self._note(path)
        self._at += 1  # the equals sign
        self._take(_BLANK)
        self._value(path)

    def _value(self, path: KeyPath) -> None:
        match self._text[self._at]:
            case "[":
                self._array(path)
            case "{":
                self._inline_table(path)
            case _:
                self._take(_SCALAR)

    def _array(self, path: KeyPath) -> None:
        index = 0
        while self._more("]"):
            self._note((*path, index))
            self._value((*path, index))
            index += 1

    def _inline_table(self, path: KeyPath) -> None:
        while self._more("}"):
            self._assignment(path)

    def _more(self, closing: str) -> bool:
        """Step over an opening bracket or a comma to the next item; False when the closing one was there."""
        self._take(_BLANK)
        if self._text[self._at] != closing:
            self._at += 1
            self._take(_BLANK)
        if self._text[self._at] != closing:
            return True
        self._at += 1
        return False

    def _key(self) -> list[str]:
        """Scan a key, dotted or not."""
        parts = [self._key_part()]
        while self._text[self._at] == ".":
            self._at += 1
            parts.append(self._key_part())
        return parts

    def _key_part(self) -> str:
        found = _KEY_PART.match(self._text, self._at)
        assert found is not None, "tomllib accepted a key that the scanner does not know"  # noqa: S101 - an invariant
        self._at = found.end()
        word = found[1]
        if word[0] not in "\"'":
            return word
        return str(ast.literal_eval(word)) if "\\" in word and word[0] == '"' else word[1:-1]  # escapes are Python's

    def _take(self, pattern: re.Pattern[str]) -> None:
        found = pattern.match(self._text, self._at)
        if found is not None:
            self._at = found.end()

    def _note(self, path: KeyPath) -> None:
        """Remember the current line as that of `path`, unless it was seen before."""
        self.lines.setdefault(path, self._line_here())

    def _line_here(self) -> int:
        self._line += self._text.count("\n", self._counted, self._at)
        self._counted = self._at
        return self._line
