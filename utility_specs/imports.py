"""Functions and classes that specs name by their import path."""

import importlib
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

from utility_specs.suggestions import hint, quoted

_refusal: ContextVar[str] = ContextVar("refusal", default="")
"""Why nothing is imported; empty: it is."""


@contextmanager
def nothing_imported(refusal: str) -> Iterator[None]:
    """Refuse what specs name in Python while they are read in here: for specs that a stranger may have written."""
    token = _refusal.set(refusal)
    try:
        yield
    finally:
        _refusal.reset(token)


def imported(path: str, what: str = "function") -> Callable[..., Any]:
    """Import the callable that `package.module:name` names; raises ValueError, which says what is wrong.

    `what` it should be, messages say.
    Whatever Python of the process can import will do: installed packages, and what `PYTHONPATH` has.
    """
    if not re.fullmatch(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*", path):
        raise ValueError(f'{quoted(path)} is not the path of a {what}; write "package.module:name"')
    if refusal := _refusal.get():
        raise ValueError(f"{quoted(path)} is not imported: {refusal}")
    where, name = path.split(":")
    try:
        module = importlib.import_module(where)
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # noqa: BLE001 - a module may fail in any way
        cause = " ".join(f"{type(error).__name__}: {error}".split())
        raise ValueError(f"cannot import {quoted(where)}: {cause}") from None
    if not hasattr(module, name):
        public = [each for each in vars(module) if not each.startswith("_") and callable(getattr(module, each))]
        raise ValueError(f"{quoted(where)} has no {quoted(name)}{hint(name, public)}")
    found: Callable[..., Any] = getattr(module, name)
    if not callable(found):
        raise ValueError(f"{quoted(path)} is a {type(found).__name__}, not a {what}")  # noqa: TRY004 - for pydantic
    return found
