"""Files as they were named on the command line, and what is said of those that cannot be read or written."""

import os
from collections.abc import Collection, Sequence
from pathlib import Path


def once(paths: Sequence[Path], parts: Collection[str] = ()) -> list[Path]:
    """Return each file once, by its first name: patterns overlap, and traffic that is read twice counts twice.

    Files that end in one of `parts` belong to their folder: they are left out where that is named, too.
    """
    found: dict[Path, Path] = {}
    for path in paths:
        found.setdefault(Path(os.path.realpath(path)), path)
    return [path for real, path in found.items() if real.suffix not in parts or real.parent not in found]


def reason_of(error: OSError) -> str:
    """Say what cannot be read or written. Raises the error again where nobody reads our output: that is no mistake."""
    if isinstance(error, BrokenPipeError):
        raise error
    return f"{error.filename}: {error.strerror}" if error.filename else error.strerror or str(error)
