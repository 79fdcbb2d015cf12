"""What messages of ROS 2 consist of. Needs the package `rosbags`, the extra `ros2`."""

import importlib
from collections.abc import Iterable
from functools import cache
from typing import Any, Literal

from utility_specs.features.path import Step
from utility_specs.suggestions import hint, quoted

Distro = Literal["humble", "iron", "jazzy", "kilted"]

_ARRAYS = {"ARRAY", "SEQUENCE"}
_EXTRA = 'needs the package rosbags: pip install rosbags (or Sendworthy with its extra "ros2")'


@cache
def typestore(distro: Distro, name: str, definition: str | None) -> Any:
    """Return rosbags' store of the types of a distribution and of those in a definition of the type `name`.

    Raises ValueError, which says what is wrong, or what to install.
    """
    try:
        typesys = importlib.import_module("rosbags.typesys")
    except ImportError:
        raise ValueError(_EXTRA) from None
    store = typesys.get_typestore(typesys.Stores(f"ros2_{distro}"))
    try:
        if definition is not None:
            store.register(typesys.get_types_from_msg(definition, name))
        if name in store.fielddefs:
            store.get_msgdef(name)
    except typesys.TypesysError as error:
        raise ValueError("the definition cannot be used: " + " ".join(str(error).split())) from None
    except KeyError as error:
        raise ValueError(f"the definition uses {quoted(str(error.args[0]))}, which is not known") from None
    except RecursionError:
        raise ValueError("the definition cannot be used: a type is in itself, or too deep in others") from None
    if name not in store.fielddefs:
        raise ValueError(f"unknown type {quoted(name)}" + _likely(name, store.fielddefs))
    return store


def _likely(name: str, known: Iterable[str]) -> str:
    """Return a hint if a known type is close to the name; all names are much alike."""
    from difflib import get_close_matches

    close = get_close_matches(name, known, n=1, cutoff=0.85)
    return f" (did you mean {quoted(close[0])}?)" if close else "; add a definition of it"


def field_of(store: Any, name: str, steps: tuple[Step, ...]) -> Any:
    """Return rosbags' description of a field of a type; raises ValueError where there is none."""
    node: Any = (importlib.import_module("rosbags.interfaces").Nodetype.NAME, name)
    for step in steps:
        kind, of = node[0].name, node[1]
        if kind in _ARRAYS:
            if isinstance(step, str):
                raise ValueError(f"before {quoted(step)} there is an array: write [0] or [*]")
            node = of[0]
            continue
        fields = dict(store.fielddefs[of][1]) if kind == "NAME" else {}
        if step not in fields:
            what = of if kind == "NAME" else f"a {of[0]}"
            raise ValueError(f"{what} has no field {quoted(str(step))}" + hint(str(step), fields))
        node = fields[step]
    return node


def check_number(field: Any, *, compared: bool, reduction: str | None) -> None:
    """Raise ValueError where what is in a field becomes no number."""
    kind, of = field[0].name, field[1]
    if kind in _ARRAYS and reduction is None:
        raise ValueError('is an array: add an index, or reduce = "max", "min", "mean", "sum" or "length"')
    if kind in _ARRAYS:
        kind, of = of[0][0].name, of[0][1]
    if reduction == "length":
        return
    if kind == "NAME":
        raise ValueError(f"is a {of}: name a field of it")
    if of[0] == "string" and not compared:
        raise ValueError('is text: add equals = "…"')
