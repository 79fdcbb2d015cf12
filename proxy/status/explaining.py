"""What each column and word of the status means: for the terminal, and as docs/reference/status.md."""

import textwrap
from collections.abc import Iterator, Sequence

from proxy.status.tables import TABLES
from proxy.status.words import GLOSSARIES

INTRODUCTION = """\
`sendworthy status` shows what a daemon does: who it is, what is wrong (`warning:`), what became of the samples of \
this robot's applications, how much of the limits is used, how it was decided, which streams there are, and who else \
is on the mesh. A section without rows is left out, and in a narrow terminal the less important columns are."""
TIMES = "Times, sizes and counts are since the daemon's start, or as of now. A dash means that nothing is known yet."
COMMAND = """\
<!-- Made by `python -m proxy.status.explaining`; a test compares. -->
# What `sendworthy status` shows"""
JSON = """\
## As JSON

`sendworthy status --json` has all of it and more, `sendworthy schema status` describes every field with its unit, as \
a [JSON Schema](status.schema.json). `status_version` rises when a field is renamed, goes, or means something else. \
Fields may be added without: programs should ignore those that they do not know. The last column above names the \
fields that a column is made of."""
TOP = """\
## Live

`sendworthy top` shows the same live, with rates instead of counts (made, sent and dropped in a second), and why \
samples are dropped. Press `?` in it for its keys."""

Entry = tuple[str, str, str]
"""A word, its meaning, and the fields of the JSON that it is made of."""


def sections() -> Iterator[tuple[str, str, Sequence[Entry]]]:
    """Yield the title of each section, what it is about, and its entries."""
    for table in TABLES:
        fields = [
            ", ".join(f"{table.path}.{name}" for name in column.fields) if column.fields else table.path
            for column in table.columns
        ]
        yield (
            table.title,
            table.means,
            [(c.head, c.means, field) for c, field in zip(table.columns, fields, strict=True)],
        )
    for glossary in GLOSSARIES:
        yield glossary.title, "", [(word, meaning, "") for word, meaning in glossary.words.items()]


def explained(width: int) -> str:
    """Return the explanation for a terminal of this width."""
    parts = ["\n".join(textwrap.wrap(INTRODUCTION.replace("`", ""), width)), "\n".join(textwrap.wrap(TIMES, width))]
    for title, about, entries in sections():
        indent = max(len(word) for word, _, _ in entries) + 4
        lines = textwrap.wrap(f"{title}. {about}" if about else title, width)
        for word, meaning, _ in entries:
            lines += textwrap.wrap(
                meaning, width, initial_indent=f"  {word}".ljust(indent), subsequent_indent=" " * indent
            )
        parts.append("\n".join(lines))
    return "\n\n".join(parts)


def page() -> str:
    """Return docs/reference/status.md."""
    parts = [COMMAND, INTRODUCTION, TIMES]
    for title, about, entries in sections():
        fields = any(field for _, _, field in entries)
        head = ["| column | what it says | JSON |", "|---|---|---|"] if fields else ["| word | meaning |", "|---|---|"]
        rows = [
            f"| {word} | {meaning} | {_code(field)} |" if fields else f"| {word} | {meaning} |"
            for word, meaning, field in entries
        ]
        parts.append("\n\n".join([f"## {title}", *([about] if about else []), "\n".join([*head, *rows])]))
    return "\n\n".join([*parts, JSON, TOP]) + "\n"


def _code(fields: str) -> str:
    return ", ".join(f"`{field}`" for field in fields.split(", "))


if __name__ == "__main__":
    print(page(), end="")
