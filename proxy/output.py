"""Files that a command is told to write: looked at before its work, which may take minutes."""

import os
from collections.abc import Iterable
from errno import EACCES, EISDIR, ENOENT, ENOTDIR
from pathlib import Path


def check_writable(paths: Iterable[Path | None], *, folders: bool = False) -> None:
    """Raise OSError, which names the file, where one could not be written. `folders` are made where there are none.

    What is not given need not be written, nor is `-`, which is standard output.
    """
    for path in paths:
        if path is not None and str(path) != "-" and (problem := _problem(path, folders=folders)):
            raise OSError(problem, os.strerror(problem), str(path))


def _problem(path: Path, *, folders: bool) -> int:
    """Return what is in the way as the system numbers it; 0: nothing."""
    if path.is_dir():
        return EISDIR
    place = next(each for each in (path, *path.absolute().parents) if each.exists())
    if place is not path and not place.is_dir():
        return ENOTDIR
    if not folders and place not in (path, path.absolute().parent):
        return ENOENT
    return 0 if os.access(place, os.W_OK) else EACCES
