"""Results for the terminal, and as pages of markdown with machine and date."""

import os
import platform
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import numpy as np

from studies.benchmarks.charts import Chart


@dataclass(frozen=True, slots=True)
class Table:
    """A table: a row starts with its name; the other cells are ready to print."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""

    def text(self) -> str:
        """Return the table for a terminal, the first column left-aligned, the others right-aligned."""
        return "\n".join([self.title, "", *(f"  {line}" for line in self._lines("  ")), "", self.note]).rstrip()

    def markdown(self) -> str:
        """Return the table as a section of a markdown page."""
        head, *body = (f"| {line} |" for line in self._lines(" | "))
        rule = "|".join(["", *(("---" if i == 0 else "--:") for i in range(len(self.columns))), ""])
        return "\n".join([f"## {self.title}", "", head, rule, *body, "", self.note]).rstrip()

    def _lines(self, between: str) -> list[str]:
        widths = [max(map(len, cells)) for cells in zip(self.columns, *self.rows, strict=True)]
        lines = []
        for cells in (self.columns, *self.rows):
            padded = [cells[0].ljust(widths[0])]
            padded += [cell.rjust(width) for cell, width in zip(cells[1:], widths[1:], strict=True)]
            lines.append(between.join(padded))
        return lines


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture that is there already, as the text of an SVG; a page has one."""

    title: str
    svg: str


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure that `draw` writes into a folder as SVG and PNG; it returns their name without what follows the dot."""

    title: str
    draw: Callable[[Path], str]


Result = Table | Chart | Picture | Figure


def machine() -> str:
    """Describe the machine in one line."""
    model = platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        names = [line.split(":", 1)[1].strip() for line in cpuinfo.read_text().splitlines() if "model name" in line]
        model = names[0] if names else model
    versions = f"Python {platform.python_version()}, NumPy {np.__version__}"
    return f"{model}, {os.cpu_count()} cores, {platform.system()}, {versions}"


def write_page(
    path: Path,
    title: str,
    results: Sequence[Result],
    now: datetime,
    command: str = "python -m studies.benchmarks",
) -> None:
    """Write tables and charts to a markdown page, the pictures beside it; folders are made as needed.

    The page names the `command` that wrote it.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    origin = f"{now:%Y-%m-%d %H:%M} UTC. {machine()}"
    sections = [f"# {title}", f"Written by `{command}` on {origin}."]
    for result in results:
        if isinstance(result, Table):
            sections.append(result.markdown())
        elif isinstance(result, Picture):
            picture = path.with_suffix(".svg")
            picture.write_text(result.svg, encoding="utf-8")
            sections.append(f"![{result.title}]({picture.name})")
        elif isinstance(result, Figure):
            name = result.draw(path.parent)
            sections += [f"![{result.title}]({name}.png)", f"([{name}.svg]({name}.svg))"]
        else:
            picture = path.with_name(f"{path.stem}-{result.file_name()}")
            result.draw(picture, origin)
            sections.append(f"![{result.title}]({picture.name})")
    path.write_text("\n\n".join(sections) + "\n")
