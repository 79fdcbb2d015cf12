"""A curve drawn with characters: Braille patterns, of which each has two by four dots, or plain ASCII."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

WIDTH, HEIGHT = 60, 12
"""Characters of the area in which the curve is drawn."""

_BLANK = 0x2800
_BITS = ((0x01, 0x02, 0x04, 0x40), (0x08, 0x10, 0x20, 0x80))
"""Of the dots of a Braille pattern, by column and row."""


@dataclass(frozen=True, slots=True)
class Style:
    """What is drawn with: dots in a character, how dots become one, and the lines of the axes."""

    across: int
    down: int
    vertical: str
    corner: str
    horizontal: str

    @property
    def sample(self) -> str:
        """Characters of every kind that it takes."""
        return self.vertical + self.corner + self.horizontal + self.character(1)

    def character(self, dots: int) -> str:
        """Return the character with these dots."""
        if self.across == 1:
            return "*" if dots else " "
        return chr(_BLANK | dots) if dots else " "


BRAILLE = Style(2, 4, "┤", "└", "─")
ASCII = Style(1, 1, "|", "+", "-")


def plot(
    values: Sequence[float],
    x_labels: Sequence[str],
    y_label: Callable[[float], str],
    *,
    height: int = HEIGHT,
    style: Style = BRAILLE,
) -> list[str]:
    """Return the lines of a plot of `values`, at equal distances, as many for each character as `style` is across.

    The vertical axis goes from 0 to the greatest value; `x_labels` stand at equal distances below the horizontal one.
    """
    top = max(values)
    rows = height * style.down
    width = -(-len(values) // style.across)
    dots = [[0] * width for _ in range(height)]
    for x, y in _line([_row(value, top, rows) for value in values]):
        bit = _BITS[x % 2][y % 4] if style.across == 2 else 1
        dots[y // style.down][x // style.across] |= bit
    labels = {0: y_label(top), height // 2: y_label(top * (1.0 - (height // 2) / height)), height: y_label(0.0)}
    margin = max(map(len, labels.values()))
    lines = [
        f"{labels.get(number, ''):>{margin}} {style.vertical}{''.join(map(style.character, row))}".rstrip()
        for number, row in enumerate(dots)
    ]
    axis = f"{labels[height]:>{margin}} {style.corner}{style.horizontal * width}"
    return [*lines, axis, " " * (margin + 2) + _spread(x_labels, width)]


def _row(value: float, top: float, rows: int) -> int:
    """Return the row of dots of a value, from 0 at the top."""
    part = value / top if top > 0.0 else 0.0
    return min(rows - 1, int((1.0 - part) * rows))


def _line(rows: Sequence[int]) -> list[tuple[int, int]]:
    """Return the dots of a line through a row in every column, without gaps."""
    dots = [(0, rows[0])]
    for x, (before, row) in enumerate(pairwise(rows), start=1):
        step = 1 if row > before else -1
        dots += [(x, y) for y in range(before + step, row, step)]
        dots.append((x, row))
    return dots


def _spread(labels: Sequence[str], width: int) -> str:
    """Return the labels on one line: the first at the left end, the last at the right one, the others between."""
    line, gaps = "", max(1, len(labels) - 1)
    for number, label in enumerate(labels):
        start = round((width - len(label)) * number / gaps)
        line = line.ljust(max(start, len(line) + bool(line))) + label
    return line
