"""Utilities of messages as mission files have them: `{"kind": "linear", "slope": 0.5}`."""

from collections.abc import Mapping
from typing import Any

from planner import Exponential, Linear, MessageUtility, Polynomial, Step, Video
from planner.utility import Power, Table

KINDS: dict[str, tuple[type[Any], tuple[str, ...]]] = {
    "linear": (Linear, ("u0", "slope")),
    "exponential": (Exponential, ("u0", "tau")),
    "step": (Step, ("u0", "lifetime")),
    "polynomial": (Polynomial, ("u0", "a1", "k")),
    "video": (Video, ("a0", "a1")),
    "power": (Power, ("beta",)),
    "table": (Table, ("points",)),
}
"""By kind: the planner's function, and its parameters (MODEL in `planner/README.md`); all of them are written."""


def utility_of(table: Mapping[str, Any]) -> MessageUtility:
    """Return the function. Raises ValueError or ProblemError."""
    kind = table.get("kind")
    if kind not in KINDS:
        raise ValueError(f"kind is one of {', '.join(KINDS)}, not {kind!r}")
    function, names = KINDS[str(kind)]
    given = {name: value for name, value in table.items() if name != "kind"}
    if set(given) != set(names):
        raise ValueError(f"{kind} has {', '.join(names)}, not {', '.join(given) or 'nothing'}")
    if kind == "table":
        return Table(_points(given["points"]))
    for name, value in given.items():
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ValueError(f"{name} is a number, not {value!r}")  # noqa: TRY004 - of whoever wrote the file
    made: MessageUtility = function(**given)
    return made


def table_of(utility: MessageUtility) -> dict[str, Any]:
    """Return the table of a function. Raises ValueError for one of no such kind."""
    for kind, (function, names) in KINDS.items():
        if type(utility) is function:
            return {"kind": kind} | {name: _plain(getattr(utility, name)) for name in names}
    raise ValueError(f"a mission file has no utility of the kind {type(utility).__name__}")


def spec_of(table: Mapping[str, Any]) -> str:
    """Write the function as a utility spec has it."""
    rest = (f"{name} = {value!r}" for name, value in table.items() if name != "kind")
    return f'{{ kind = "{table["kind"]}", {", ".join(rest)} }}'


def _points(given: Any) -> tuple[tuple[float, float], ...]:
    try:
        return tuple((float(age), float(value)) for age, value in given)
    except (TypeError, ValueError):
        raise ValueError("points are pairs of age [s] and value") from None


def _plain(value: Any) -> Any:
    return [list(point) for point in value] if isinstance(value, tuple) else value
