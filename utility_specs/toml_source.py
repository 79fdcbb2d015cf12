"""A TOML file with the places of its keys, so that a mistake can be shown where it was made.

source = TomlSource.read(path)                       # raises TomlError
try:
    model.model_validate(source.data)
except ValidationError as error:
    raise SpecsError(problems_of(error, source, model)) from None
"""

import re
import sys
import tomllib
from bisect import bisect_left
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, Self

from pydantic import BaseModel, ValidationError

from utility_specs.effort import UNJUDGED
from utility_specs.errors import SpecProblem, TomlError
from utility_specs.suggestions import quoted
from utility_specs.toml_lines import KeyPath, lines_of
from utility_specs.wording import Place, Schema, message_of

LARGEST_FILE = 128 * 1024
"""Bytes of the largest file that is read: as many types as one may have, each with a page of comments."""
MOST_MARKS = 3072
"""Signs of keys and values (`=`, `,`, `[`, `{`, `.`) outside comments; each takes `tomllib` some microseconds."""

MOST_PROBLEMS = 50
"""How many problems of one file are told; the others are counted."""
MOST_JUDGED = 200
"""Of so many, the first in the order of the file."""

_KEY_PART = r"""(?:(?<![\w-])[\w-]++|"[^"\n]*+"|'[^'\n]*+')"""
_ENDLESS_KEY = re.compile(rf"{_KEY_PART}(?:[ \t]*+\.[ \t]*+{_KEY_PART}){{64}}")
"""A dotted key of more than 64 parts: `tomllib` needs quadratic time for it."""

_COMMENT = re.compile(r"^[ \t]*+#.*+$", re.MULTILINE)

_NAMESPACE = re.compile(r"\('.*'(?:, '.*')*,?\)")
"""A key as `tomllib` shows it in some messages: a tuple."""

_BARE = re.compile(r"=[ \t]*+((?:[0-9][0-9.]*+[ \t]*+)?[A-Za-z%\u00b5\u03bc][\w/%]*+)[ \t]*+(?:[,}#]|$)")
"""A word, or a number and a unit, that stands after an equals sign without quotes."""
_WORDS = {"true", "false", "inf", "nan"}
"""What TOML writes so."""

_PLACE = re.compile(r" \(at (?:line (\d+), column (\d+)|end of document)\)$")


@dataclass(frozen=True, slots=True)
class TomlSource:
    """A parsed file: `data` as `tomllib` gives it, `text` and the line of every key."""

    path: Path
    data: dict[str, Any]
    text: str = field(default="", repr=False)
    _lines: dict[KeyPath, int] = field(default_factory=dict, repr=False)

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read and parse a file; raises TomlError, which names file and line."""
        return cls.parse(path, _text_of(path))

    @classmethod
    def parse(cls, path: Path, text: str) -> Self:
        """Parse the text of the file `path`; raises TomlError."""
        if marks(text) > MOST_MARKS:
            raise _error(path, None, f"has more than {MOST_MARKS} keys and values; write several files")
        endless = _ENDLESS_KEY.search(text)
        if endless is not None:
            raise _error(path, text.count("\n", 0, endless.start()) + 1, "a key of more than 64 parts")
        try:
            return cls(path, tomllib.loads(text), text, lines_of(text))
        except RecursionError:
            raise _error(path, None, "arrays or tables are nested too deeply") from None
        except tomllib.TOMLDecodeError as error:
            raise _syntax_error(path, text, str(error)) from None
        except ValueError:
            most = sys.get_int_max_str_digits()
            raise _error(path, _line_of_huge(text), f"not valid TOML: a number of more than {most} digits") from None

    def line_of(self, path: KeyPath) -> int | None:
        """Return the line of a key, or that of the nearest table around it; None when there is none."""
        for length in range(len(path), 0, -1):
            if path[:length] in self._lines:
                return self._lines[path[:length]]
        return None

    def problem(self, path: KeyPath, message: str) -> SpecProblem:
        """Return the problem `message` at a key."""
        return SpecProblem(self.path, self.line_of(path), self.label(path), message)

    def label(self, path: KeyPath) -> str:
        """Return a key path as messages show it: `information_type "camera": features.red.color`."""
        label = ""
        value: Any = self.data
        for part in path:
            value = _child(value, part)
            if not isinstance(part, int):
                joint = "" if not label or label.endswith(": ") else "."
                label += joint + _shown(part)
            elif isinstance(value, dict):
                name = value.get("name")
                label += f" {quoted(name)}: " if isinstance(name, str) and name else f" #{part + 1}: "
            else:
                label += f"[{part}]"
        return label.removesuffix(": ")


def marks(text: str) -> int:
    """Return how many signs of keys and values there are, at least; what stands in lines of comments is none."""
    return sum(map(_COMMENT.sub("", text).count, "=,[{."))


def problems_of(error: ValidationError, source: TomlSource, model: type[BaseModel] | None = None) -> list[SpecProblem]:
    """Return what pydantic found wrong with a file's data as problems with lines, in the order of the file.

    With the `model` that refused the data, unknown keys come with hints and paths without the tags of unions.
    """
    schema = _schema_of(model) if model is not None else {}
    judged = [detail for detail in error.errors(include_url=False) if detail["type"] != UNJUDGED]
    details = judged[:MOST_JUDGED]
    places = [Place.find(schema, detail["loc"], detail["type"]) for detail in details]
    found = sorted(zip(places, details, strict=True), key=lambda each: source.line_of(each[0].path) or 0)
    problems = [source.problem(place.path, message_of(detail, place)) for place, detail in found[:MOST_PROBLEMS]]
    if len(judged) > MOST_PROBLEMS:
        problems.append(SpecProblem(source.path, None, "", f"has {len(judged) - MOST_PROBLEMS} more mistakes"))
    if len(judged) < error.error_count():
        problems.append(SpecProblem(source.path, None, "", "is not judged any further"))
    return problems


@cache
def _schema_of(model: type[BaseModel]) -> Schema:
    return model.model_json_schema()


def _child(value: Any, part: str | int) -> Any:
    """Return an element of a table or an array; None when there is no such element."""
    try:
        return value[part]
    except (KeyError, IndexError, TypeError):
        return None


def _shown(part: str) -> str:
    return part if re.fullmatch(r"[\w-]+", part) else quoted(part)


def is_no_file(path: Path) -> bool:
    """Whether there is something else than a file: who reads a pipe or a device may never come to its end."""
    return path.exists() and not path.is_file()


def _text_of(path: Path) -> str:
    """Read a file of at most `LARGEST_FILE` bytes as UTF-8, without a byte order mark; raises TomlError."""
    try:
        if is_no_file(path):
            raise _error(path, None, "is not a file")
        with path.open("rb") as file:
            raw = file.read(LARGEST_FILE + 1)
    except FileNotFoundError:
        raise _error(path, None, "does not exist") from None
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        raise _error(path, None, f"cannot be read: {getattr(error, 'strerror', None) or error}") from None
    if len(raw) > LARGEST_FILE:
        raise _error(path, None, f"is larger than {LARGEST_FILE // 1024} KiB")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise _error(path, line, f"is not UTF-8 (byte 0x{raw[error.start]:02x}); save the file as UTF-8") from None


def _syntax_error(path: Path, text: str, message: str) -> TomlError:
    """Return the error for a message of `tomllib`, which holds the place at its end."""
    found = _PLACE.search(message)
    what = message[: found.start()] if found else message
    cause = "not valid TOML: " + _NAMESPACE.sub(lambda names: names[0][2:-1].rstrip("',").replace("', '", "."), what)
    if found is None:
        return _error(path, None, cause)
    if found[1] is None:
        return _error(path, text.rstrip().count("\n") + 1, f"{cause} at the end of the file")
    line = text.split("\n")[int(found[1]) - 1]
    bare = next((word for word in _BARE.findall(line) if word not in _WORDS), None)
    quotes = "" if bare is None else f"; text and quantities stand in quotes: {quoted(bare)}"
    return _error(path, int(found[1]), f"{cause} (column {found[2]}){quotes}")


def _line_of_huge(text: str) -> int:
    """Return the line of the first number that Python refuses to read: the first up to which it refuses the text."""
    lines = text.split("\n")

    def refused(number: int) -> bool:
        try:
            tomllib.loads("\n".join(lines[:number]))
        except ValueError as error:
            return not isinstance(error, tomllib.TOMLDecodeError)
        return False

    return bisect_left(range(len(lines)), True, key=refused)


def _error(path: Path, line: int | None, message: str) -> TomlError:
    return TomlError([SpecProblem(path, line, "", message)])
