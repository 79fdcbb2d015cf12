"""Traffic from CSV: the columns `t_gen` [s], `robot`, `key`, `size` [B]; other columns of numbers are features.

Fields are separated by what the header is separated by: commas, semicolons or tabs. A column is of text, and ignored,
if the first field that says anything is no number; from then on each field of a column of numbers must be one, or
empty. Nothing but one line is held; lines that are not in the order of time are put in order on the disk.
"""

import csv
import math
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from heapq import merge
from operator import attrgetter
from pathlib import Path
from pickle import dump, load
from typing import NoReturn, TextIO

import zenoh

from proxy.config_values import robot_name
from studies.foreign.arrived import Arrived
from studies.foreign.errors import ImportFailedError
from utility_specs.suggestions import hint, quoted

NEEDED = ("t_gen", "robot", "key", "size")
SEPARATORS = ",;\t"
LONGEST_LINE = 64 * 1024
"""Characters; longer ones are no line of a table."""
LARGEST = 2**32
"""Bytes of a sample; no message is as large."""
LATEST = 1e11
"""No clock shows more [s]."""
RUN = 100_000
"""Lines that are put in order in memory."""


@dataclass(slots=True)
class Table:
    """A CSV file; `ignored` are its columns of text, once they were seen to be that."""

    path: Path
    ignored: list[str] = field(default_factory=list)

    def samples(self) -> Iterator[Arrived]:
        """Yield its samples in the order of time. Raises ImportFailedError, by line and column, or OSError."""
        if self._in_order():
            yield from self._read()
        else:
            yield from _sorted(self._read())

    def _in_order(self) -> bool:
        """Read everything once, so that nothing is written for a file with a mistake in it."""
        last, count, ordered = -math.inf, 0, True
        for each in self._read():
            ordered = ordered and each.t_gen >= last
            last, count = each.t_gen, count + 1
        if not count:
            raise ImportFailedError(f"{self.path} has no line below its header")
        return ordered

    def _read(self) -> Iterator[Arrived]:
        try:
            with self.path.open(encoding="utf-8-sig", newline="") as file:
                yield from self._rows(file)
        except UnicodeDecodeError as error:
            raise ImportFailedError(f"{self.path} is no text in UTF-8, and so no CSV: {error.reason}") from None

    def _rows(self, file: TextIO) -> Iterator[Arrived]:
        header = file.readline(LONGEST_LINE)
        if not header.strip():
            raise ImportFailedError(f"{self.path} is empty" if not header else f"{self.path}:1: the header is empty")
        separator = max(SEPARATORS, key=header.count)
        columns = [name.strip() for name in next(csv.reader([header], delimiter=separator))]
        self._check_header(columns)
        rows = csv.reader(_lines(file, self.path), delimiter=separator, strict=True)
        line = _Line(self.path, columns)
        try:
            for row in rows:
                line.number = rows.line_num + 1
                if any(each.strip() for each in row):
                    yield line.sample(row)
        except csv.Error as error:
            raise ImportFailedError(f"{self.path}:{rows.line_num + 1}: this is no line of CSV: {error}") from None
        self.ignored = [name for name, numbers in line.numbers.items() if not numbers]

    def _check_header(self, columns: Sequence[str]) -> None:
        for name in columns:
            if name and columns.count(name) > 1:
                raise ImportFailedError(f"{self.path}:1: the column {quoted(name)} is there twice")
        for name in NEEDED:
            if name not in columns:
                likely = hint(name, [each for each in columns if each and each not in NEEDED])
                raise ImportFailedError(f"{self.path}:1: there is no column {quoted(name)}{likely}")


@dataclass(slots=True)
class _Line:
    """Reads one line after the other; `numbers` tells of each further column whether it is of numbers, once known."""

    path: Path
    columns: list[str]
    number: int = 0
    numbers: dict[str, bool] = field(default_factory=dict)

    def sample(self, row: list[str]) -> Arrived:
        """Return the sample of a line."""
        if len(row) != len(self.columns):
            found = f"{len(row)} fields" if len(row) != 1 else "one field"
            raise ImportFailedError(f"{self.path}:{self.number}: {found}, but the header has {len(self.columns)}")
        fields = {name: text.strip() for name, text in zip(self.columns, row, strict=True)}
        t_gen = self._number("t_gen", fields["t_gen"])
        if abs(t_gen) > LATEST:
            self._fail("t_gen", f"{fields['t_gen']} s is no time: is it in nanoseconds?")
        size = self._number("size", fields["size"])
        if not (size.is_integer() and 0 <= size <= LARGEST):
            self._fail("size", f"{quoted(fields['size'])} is not a whole number of bytes")
        key = fields["key"]
        if not is_key(key):
            self._fail("key", f"{quoted(key)} is no key; write for example robot/r1/camera, without / at the ends")
        return Arrived(t_gen, self._robot(fields["robot"]), key, int(size), self._features(fields))

    def _robot(self, name: str) -> str:
        try:
            return robot_name(name)
        except ValueError as error:
            self._fail("robot", str(error))

    def _features(self, fields: dict[str, str]) -> dict[str, float]:
        found = {}
        for name, text in fields.items():
            if not name or name in NEEDED or not text or self.numbers.get(name) is False:
                continue
            if name not in self.numbers:
                self.numbers[name] = _is_number(text)
            if self.numbers[name] and math.isfinite(value := self._number(name, text, infinite=True)):
                found[name] = value
        return found

    def _number(self, column: str, text: str, *, infinite: bool = False) -> float:
        try:
            value = float(text)
        except ValueError:
            self._fail(column, f"{quoted(text)} is not a number" if text else "is empty")
        if not math.isfinite(value) and not infinite:
            self._fail(column, f"{text} is not finite")
        return value

    def _fail(self, column: str, what: str) -> NoReturn:
        where = f"{self.path}:{self.number}: column {quoted(column)} ({self.columns.index(column) + 1})"
        raise ImportFailedError(f"{where}: {what}")


def is_key(text: str) -> bool:
    """Whether this is a key of Zenoh, not an expression for several."""
    try:
        zenoh.KeyExpr(text)
    except zenoh.ZError:
        return False
    return "*" not in text


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _lines(file: TextIO, path: Path) -> Iterator[str]:
    """Yield lines, none of which takes the memory."""
    number = 1
    while line := file.readline(LONGEST_LINE):
        number += 1
        if len(line) == LONGEST_LINE:
            raise ImportFailedError(f"{path}:{number}: the line has more than {LONGEST_LINE:,} characters")
        if "\0" in line:
            raise ImportFailedError(f"{path}:{number}: there are zero bytes in it: this is no CSV")
        yield line


def _sorted(samples: Iterator[Arrived]) -> Iterator[Arrived]:
    """Yield samples in the order of time: runs of them are sorted in memory, kept on the disk, and merged."""
    with tempfile.TemporaryDirectory(prefix="sendworthy-import-") as folder:
        runs, held = list[Path](), list[Arrived]()
        for each in samples:
            held.append(each)
            if len(held) == RUN:
                runs.append(_kept(held, Path(folder) / str(len(runs))))
                held = []
        held.sort(key=attrgetter("t_gen"))
        yield from merge(*map(_again, runs), held, key=attrgetter("t_gen"))


def _kept(run: list[Arrived], path: Path) -> Path:
    run.sort(key=attrgetter("t_gen"))
    with path.open("wb") as file:
        for each in run:
            dump(each, file)
    return path


def _again(path: Path) -> Iterator[Arrived]:
    with path.open("rb") as file:
        while True:
            try:
                yield load(file)  # noqa: S301 - we wrote it
            except EOFError:
                return
