"""Whether an answer has the shape of a status: any application may answer in a daemon's place, anything."""

import sys
from functools import cache
from typing import Any, Literal, get_args, get_origin

from proxy.status.fields import Part
from proxy.status.model import Status


def fits(value: object, kind: Any = Status) -> bool:
    """Whether what is described of a value is of its kind, a type of the model.

    What is missing fits, and so does what is not described: daemons of other versions say less, or more.
    """
    if kind in (int, float):
        whole = isinstance(value, int) and abs(value) <= sys.float_info.max
        return whole or (kind is float and isinstance(value, float))
    fields, origin, inner = _parts(kind)
    if fields is not None:
        return isinstance(value, dict) and all(
            fits(each, fields[name]) for name, each in value.items() if name in fields
        )
    if origin is list:
        return isinstance(value, list) and all(fits(each, inner[0]) for each in value)
    if origin is dict:
        return isinstance(value, dict) and all(fits(each, inner[1]) for each in value.values())
    if origin is Literal:
        return isinstance(value, type(inner[0]))  # other versions may know other words
    return any(fits(value, each) for each in inner) if inner else isinstance(value, kind)


@cache
def _parts(kind: Any) -> tuple[dict[str, Any] | None, Any, tuple[Any, ...]]:
    """Return the kinds of a table's fields, if it is one, and the origin and the arguments of a type."""
    table = isinstance(kind, type) and issubclass(kind, Part)
    fields = {each.alias or name: each.annotation for name, each in kind.model_fields.items()} if table else None
    return fields, get_origin(kind), get_args(kind)
