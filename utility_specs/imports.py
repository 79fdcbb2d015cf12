"""Functions that specs name by their import path."""

import importlib
import re
from collections.abc import Callable
from typing import Any

from utility_specs.suggestions import hint, quoted


def imported(path: str) -> Callable[..., Any]:
    """Import the callable that `package.module:name` names; raises ValueError, which says what is wrong.

    Whatever Python of the process can import will do: installed packages, and what `PYTHONPATH` has.
    """
    if not re.fullmatch(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*", path):
        raise ValueError(f'{quoted(path)} is not the path of a function; write "package.module:name"')
    where, name = path.split(":")
    try:
        module = importlib.import_module(where)
    except (Exception, SystemExit) as error:  # noqa: BLE001 - a module may fail in any way
        what = " ".join(f"{type(error).__name__}: {error}".split())
        raise ValueError(f"cannot import {quoted(where)}: {what}") from None
    if not hasattr(module, name):
        public = [each for each in vars(module) if not each.startswith("_") and callable(getattr(module, each))]
        raise ValueError(f"{quoted(where)} has no {quoted(name)}{hint(name, public)}")
    function: Callable[..., Any] = getattr(module, name)
    if not callable(function):
        raise ValueError(f"{quoted(path)} is a {type(function).__name__}, not a function")  # noqa: TRY004 - for pydantic
    return function
