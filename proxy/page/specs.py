"""Specs as the page has them: files by name, checked as `sendworthy check` does."""

import tempfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from proxy.errors import PushError
from proxy.pushed import pack
from utility_specs import Specs, SpecsError, load_specs
from utility_specs.check import Report

Files = Mapping[str, str]
"""The text of files, by name."""


class NoRoomError(PushError):
    """Specs cannot be written to a temporary folder, as its disk is full or it is not there."""


@dataclass(frozen=True, slots=True)
class InForce:
    """The specs that a daemon says are in force. `problem` tells why they are not understood here, if so.

    `passing`: they may be understood later, as nothing is wrong with them.
    """

    generation: str = ""
    files: Files = field(default_factory=dict)
    specs: Specs = field(default_factory=Specs.empty)
    problem: str = ""
    passing: bool = False

    @classmethod
    def of(cls, generation: str, files: Files) -> "InForce":
        """Read them: they may need Python modules that only the robots have."""
        if not files:
            return cls(generation)
        try:
            with _folder(files) as folder:
                try:
                    return cls(generation, files, load_specs(folder))
                except SpecsError as error:
                    problem = str(error.problems[0]).replace(f"{folder}/", "")
        except NoRoomError as error:
            return cls(generation, files, problem=str(error), passing=True)
        except PushError as error:
            problem = str(error)
        return cls(generation, files, problem=problem)


def checked(files: Files) -> dict[str, Any]:
    """Return what `sendworthy check` finds, as plain JSON data; each mistake with file, line and key.

    Raises PushError when they cannot be files of specs at all.
    """
    with _folder(files) as folder:
        found = Report.on([folder]).data()
    for each in (*found["errors"], *found["warnings"]):
        each["file"] = Path(each["file"]).name
        each["message"] = each["message"].replace(f"{folder}/", "")
    return {name: found[name] for name in ("fit", "errors", "warnings")}


@contextmanager
def _folder(files: Files) -> Iterator[Path]:
    """Write files to a folder for a while.

    Raises PushError for names that are none of specs, and text that is none; NoRoomError where there is no such folder.
    """
    try:
        encoded = {name: text.encode() for name, text in files.items()}
    except UnicodeEncodeError:
        raise PushError("files of specs are UTF-8, which cannot write half a surrogate pair") from None
    pack(encoded)
    with ExitStack() as closing:
        try:
            folder = Path(closing.enter_context(tempfile.TemporaryDirectory(prefix="sendworthy-page-")))
            for file, content in encoded.items():
                (folder / file).write_bytes(content)
        except OSError as error:
            raise NoRoomError(f"specs cannot be looked at here: {error.strerror}") from None
        yield folder
