"""Specs that somebody pushes: how they travel, and how they replace those in a folder, whole or not at all."""

import os
import re
import shutil
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import msgpack

from proxy.errors import PushError
from proxy.tuning import TUNING
from utility_specs import SpecsError, load_specs
from utility_specs.loader import spec_files
from utility_specs.toml_source import is_no_file

VERSION = 1
_NAME = re.compile(r"[\w-][\w.-]{0,99}\.toml")


def pack(files: Mapping[str, bytes]) -> bytes:
    """Return files by name as they travel. Raises PushError when there are too many."""
    _check(files)
    packed: bytes = msgpack.packb([VERSION, dict(files)])
    return packed


def unpack(raw: bytes) -> dict[str, bytes]:
    """Return the files by name. Raises PushError when it is something else."""
    try:
        version, files = msgpack.unpackb(raw)
    except (ValueError, TypeError):
        raise PushError("what was pushed cannot be read") from None
    if version != VERSION or not isinstance(files, dict):
        raise PushError("what was pushed is of another version of sendworthy")
    _check(files)
    return files


def gathered(paths: Iterable[Path]) -> dict[str, bytes]:
    """Read files, and the `*.toml` of folders. Raises PushError when one cannot be read or two have one name."""
    files: dict[str, bytes] = {}
    known: set[Path] = set()
    for path in paths:
        try:
            found = [(file, _content(file)) for file in spec_files(path)]
        except OSError as error:
            raise PushError(f"{error.filename}: cannot be read: {error.strerror}") from None
        for file, content in found:
            if file.name in files and file.resolve() not in known:
                raise PushError(f"{file}: there is another file of this name")
            files[file.name] = content
            known.add(file.resolve())
    return files


def _content(file: Path) -> bytes:
    """Return what is in a file, as far as it can be pushed. Raises PushError, OSError."""
    if is_no_file(file):
        raise PushError(f"{file}: is not a file")
    with file.open("rb") as opened:
        return opened.read(TUNING.pushed_bytes + 1)


class Folder:
    """Where the specs of a daemon are. What was there before the last push stays beside it, as `<name>.previous`.

    The same files pushed again, as after an answer that got lost, replace nothing: they would be the previous ones.
    """

    def __init__(self, path: Path) -> None:
        self._replaced = False
        self._path = path.resolve()
        beside = self._path.parent  # also of the root, which has no name
        self._staged = beside / f"{self._path.name}.pushed"
        self._previous = beside / f"{self._path.name}.previous"

    def put(self, files: Mapping[str, bytes]) -> None:
        """Replace what is there, if it is right. Raises SpecsError for mistakes in it and PushError for all else."""
        if self._path.is_file():
            raise PushError(f"{self._path} is a file; set specs.path to a folder, so that specs can be pushed")
        try:
            if self._holds(files):
                return
            try:
                self._stage(files)
                self._check_staged()
            except BaseException:
                shutil.rmtree(self._staged, ignore_errors=True)
                raise
            shutil.rmtree(self._previous, ignore_errors=True)
            if self._path.exists():
                self._path.rename(self._previous)
            self._staged.rename(self._path)
            self._replaced = True
        except OSError as error:
            raise PushError(f"{self._path}: cannot be replaced: {error.strerror}") from None

    def undo(self) -> None:
        """Put back what was there before this push, if there was anything."""
        if not self._replaced:
            return
        self._path.rename(self._staged)
        if self._previous.exists():
            self._previous.rename(self._path)
        shutil.rmtree(self._staged, ignore_errors=True)

    def mend(self) -> None:
        """Finish what an interrupted push began: what was staged had been found right."""
        if not self._path.exists() and self._previous.exists() and self._staged.exists():
            self._staged.rename(self._path)

    def _holds(self, files: Mapping[str, bytes]) -> bool:
        """Whether exactly these files are there."""
        if not self._path.is_dir() or {each.name for each in self._path.iterdir()} != set(files):
            return False
        return all((self._path / name).read_bytes() == content for name, content in files.items())

    def _stage(self, files: Mapping[str, bytes]) -> None:
        shutil.rmtree(self._staged, ignore_errors=True)
        self._staged.mkdir(parents=True)
        for name, content in files.items():
            with (self._staged / name).open("wb") as file:
                file.write(content)
                os.fsync(file.fileno())

    def _check_staged(self) -> None:
        try:
            load_specs(self._staged)
        except SpecsError as error:
            raise SpecsError(replace(problem, file=self._named(problem.file)) for problem in error.problems) from None

    def _named(self, file: Path) -> Path:
        """Return a staged file as who pushed it knows it."""
        return Path("specs") if file == self._staged else Path(file.name)


def _check(files: Mapping[str, bytes]) -> None:
    if not files:
        raise PushError("there is nothing to push")
    for name, content in files.items():
        if not isinstance(name, str) or not _NAME.fullmatch(name) or not isinstance(content, bytes):
            raise PushError(f"{name!r} is no name of a file of specs: letters, digits, ., _ and -, ending with .toml")
    if len(files) > TUNING.pushed_files or sum(map(len, files.values())) > TUNING.pushed_bytes:
        most = f"{TUNING.pushed_files} files of {TUNING.pushed_bytes // 1024} KiB"
        raise PushError(f"at most {most} together can be pushed")
