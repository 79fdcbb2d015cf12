"""Where in a document a value is: `pose.position[0].x`, `detections[*].score`, `["a name with a . in it"]`."""

import re
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import AfterValidator

from utility_specs.errors import FeatureError
from utility_specs.suggestions import quoted

Step = str | int | None
"""A name, an index, or None: every element."""

_STEP = re.compile(r'(?P<name>[^.\[\]"]+)|\[(?P<index>-?\d{1,9})\]|\[(?P<each>\*)\]|\["(?P<quoted>[^"]*)"\]', re.ASCII)


def steps_of(path: str) -> tuple[Step, ...]:
    """Return the steps of a path, of an empty one none; raises ValueError, which says what is wrong."""
    steps: list[Step] = []
    at = 0
    while at < len(path):
        dotted = at > 0 and path[at] == "."
        named = dotted or (at == 0 and path[at] != "[")
        found = _STEP.match(path, at + dotted)
        if found is None or (found["name"] is not None) != named:
            raise ValueError(f'{quoted(path)} is not a path; write for example "pose.position[0].x"')
        steps.append(_step(found))
        at = found.end()
    return tuple(steps)


def _step(found: re.Match[str]) -> Step:
    if found["index"] is not None:
        return int(found["index"])
    if found["each"] is not None:
        return None
    return str(found["quoted"] if found["name"] is None else found["name"])


def many(steps: tuple[Step, ...]) -> bool:
    """Whether the path leads to many values."""
    return None in steps


def follow(value: Any, steps: tuple[Step, ...]) -> Any:
    """Return what is there; after `[*]` a list of all that is there. Raises an exception when there is nothing."""
    for number, step in enumerate(steps):
        if step is None:
            return _followed(value, steps[number + 1 :])
        value = _child(value, step)
    return value


def _followed(values: Any, steps: tuple[Step, ...]) -> list[Any]:
    """Return what is there in each of the values, where something is."""
    found: list[Any] = []
    for value in values.values() if isinstance(values, Mapping) else _elements(values):
        try:
            inner = follow(value, steps)
        except (FeatureError, LookupError):
            continue
        found += inner if many(steps) else [inner]
    return found


def _child(value: Any, step: str | int) -> Any:
    if isinstance(value, Mapping):
        return value[step]
    if isinstance(step, int):
        return _elements(value)[step]
    if step in getattr(type(value), "__dataclass_fields__", ()):  # a message of ROS 2
        return getattr(value, step)
    raise FeatureError(f"a {type(value).__name__} has no {step}")


def _elements(value: Any) -> Any:
    """Return an array of any kind; raises FeatureError for all else."""
    if isinstance(value, list | tuple) or hasattr(value, "dtype"):
        return value
    raise FeatureError(f"a {type(value).__name__} has no elements")


def _path(text: str) -> str:
    steps_of(text)
    return text


Path = Annotated[str, AfterValidator(_path)]
"""A path that can be followed."""
