"""Tables for terminals: columns that say what they mean, and which of them a narrow terminal leaves out."""

import unicodedata
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from proxy.printable import clean
from proxy.quantities import Status

GAP = 2
"""Blanks between columns."""
SHORTEST_NAME = 18
"""Names are shortened to so many characters before a column is left out."""
LEAST_NAME = 6


@dataclass(frozen=True, slots=True)
class Column:
    """A column: its `head`, what it `means`, and how a row's `cell` is written.

    `fields` are those of the JSON that it is made of. The column of the highest `rank` is left out first where there is
    no room; one of rank 0 never is. A `name` may be shortened in its middle, and stands on the left.
    """

    head: str
    means: str
    cell: Callable[[Status], str]
    fields: tuple[str, ...]
    rank: int = 0
    name: bool = False
    left: bool = False


@dataclass(frozen=True, slots=True)
class Table:
    """What a row `is`, the path of the rows in the JSON, and the columns."""

    title: str
    means: str
    path: str
    columns: tuple[Column, ...]


@dataclass(frozen=True, slots=True)
class Fitted:
    """A table that fits: its columns, their heads, cells and widths, and the heads of those that had no room."""

    columns: tuple[Column, ...]
    widths: tuple[int, ...]
    rows: tuple[tuple[str, ...], ...]
    left_out: tuple[str, ...]

    def lines(self) -> list[str]:
        """Return the head and all rows as text."""
        return [self.line([column.head for column in self.columns]), *map(self.line, self.rows)]

    def line(self, cells: Iterable[str]) -> str:
        """Return one row as text."""
        return (" " * GAP).join(self.padded(cells)).rstrip()

    def padded(self, cells: Iterable[str]) -> list[str]:
        """Return the cells of one row, each as wide as its column."""
        return [
            aligned(cell, width, left=column.left or column.name)
            for cell, width, column in zip(cells, self.widths, self.columns, strict=True)
        ]


def fitted(table: Table, rows: Sequence[Status], width: int | None = None) -> Fitted:
    """Fit a table into a `width`, if there is one: names are shortened, then columns left out, then names again."""
    columns, left_out = list(table.columns), list[str]()
    cells = {column.head: [clean(column.cell(row)) for row in rows] for column in columns}
    widths = {head: max(map(width_of, (head, *each))) for head, each in cells.items()}
    while width is not None and (excess := _total(widths) - width) > 0:
        slack = sum(max(0, widths[c.head] - SHORTEST_NAME) for c in columns if c.name)
        last = max(columns, key=lambda column: column.rank)
        if excess <= slack or not last.rank:
            _shorten(widths, [c.head for c in columns if c.name], excess, SHORTEST_NAME if last.rank else LEAST_NAME)
            break
        columns.remove(last)
        left_out.append(last.head)
        del widths[last.head]
    shown = [[shortened(cell, widths[c.head]) if c.name else cell for cell in cells[c.head]] for c in columns]
    transposed = tuple(zip(*shown, strict=True))
    return Fitted(tuple(columns), tuple(widths[c.head] for c in columns), transposed, tuple(reversed(left_out)))


def _total(widths: Mapping[str, int]) -> int:
    return sum(widths.values()) + GAP * (len(widths) - 1)


def _shorten(widths: dict[str, int], names: Sequence[str], excess: int, least: int) -> None:
    """Take the excess from the widest names."""
    for _ in range(excess):
        widest = max(names, key=widths.__getitem__, default="")
        if not widest or widths[widest] <= least:
            break
        widths[widest] -= 1


def shortened(text: str, width: int) -> str:
    """Leave out the middle of a text that is wider than this."""
    if width_of(text) <= width:
        return text
    begin = end = ""
    for character in reversed(text):
        if width_of(end + character) > (2 * width) // 3:
            break
        end = character + end
    for character in text:
        if width_of(begin + character + end) > width - 1:
            break
        begin += character
    return f"{begin}…{end}"


def aligned(text: str, width: int, *, left: bool) -> str:
    """Fill a text with blanks up to a width."""
    blanks = " " * max(0, width - width_of(text))
    return text + blanks if left else blanks + text


def width_of(text: str) -> int:
    """Return how many places a text takes on a terminal."""
    if text.isascii():
        return len(text)
    return sum(
        0 if unicodedata.combining(each) else 2 if unicodedata.east_asian_width(each) in "WF" else 1 for each in text
    )
