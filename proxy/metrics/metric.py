"""What one metric is: its name, its labels, and where in the status its values are."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Literal

Status = dict[str, Any]
"""What `sendworthy status --json` shows, but in place of the streams `types`: totals by information type."""
Row = tuple[tuple[str, ...], float]
"""The values of the labels, and the value."""
PREFIX = "sendworthy_"


@dataclass(frozen=True, slots=True)
class Metric:
    """A metric named as Prometheus wants it, its unit last; every one has the label `robot`, too.

    `rows` reads its values off a status; what is not known there has no row.
    """

    name: str
    kind: Literal["counter", "gauge"]
    help: str
    rows: Callable[[Status], Iterable[Row]]
    labels: tuple[str, ...] = ()

    @property
    def exported(self) -> str:
        """The name under which values are exported."""
        return f"{PREFIX}{self.name}{'_total' * (self.kind == 'counter')}"

    @property
    def head(self) -> str:
        """What stands before its values."""
        return f"# HELP {self.exported} {self.help}\n# TYPE {self.exported} {self.kind}\n"


def single(*path: str) -> Callable[[Status], Iterator[Row]]:
    """Read the value at a path of the status."""

    def rows(status: Status) -> Iterator[Row]:
        value = at(status, path)
        if value is not None:
            yield (), float(value)

    return rows


def by_name(*path: str, only: str = "", without: str = "\0") -> Callable[[Status], Iterator[Row]]:
    """Read the table at a path of the status, as far as its names start so and not so."""

    def rows(status: Status) -> Iterator[Row]:
        for name, value in at(status, path).items():
            if name.startswith(only) and not name.startswith(without):
                yield (name,), float(value)

    return rows


def each_of(
    path: tuple[str, ...], names: tuple[str, ...], value: Callable[[Status], float | None]
) -> Callable[[Status], Iterator[Row]]:
    """Read a value of each entry of the list at a path of the status; labels are its entries of these names."""

    def rows(status: Status) -> Iterator[Row]:
        for entry in at(status, path):
            found = value(entry)
            if found is not None:
                yield tuple(str(entry[name]) for name in names), float(found)

    return rows


def entry(name: str, table: Status) -> Any:
    """Return the entry of this name."""
    return table[name]


def at(status: Status, path: tuple[str, ...]) -> Any:
    """Return what is at a path of the status."""
    for name in path:
        status = status[name]
    return status
