"""Which classes a snapshot of the core may have, and by which of their fields it has them.

Both who writes snapshots and who reads them goes by this, so that nothing is written that would not be read.
"""

from collections.abc import Iterable, Iterator
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache
from importlib import import_module
from typing import Any, NamedTuple

from planner import Aggregation, Constraint, Message, Plan, Problem, Traffic
from planner.airtime import Airtime
from planner.measures import Energy, Messages, Throughput
from planner.problem import Latest, Receiver, Stream
from planner.utility import Exponential, Linear, Polynomial, Power, Step, Video
from proxy.recording.errors import RecordingError
from utility_specs.forecast import FeatureForecast, Last, Mean, Trend
from utility_specs.lifetimes import Lifetime
from utility_specs.schedules import PeriodicRule, PoissonRule, TimesRule

CORE = "proxy.core."
"""What the modules begin with all of whose classes a snapshot may have."""
OTHERS: tuple[type, ...] = (
    *(Aggregation, Constraint, Latest, Message, Plan, Problem, Receiver, Stream, Traffic),
    *(Airtime, Energy, Messages, Throughput),
    *(Exponential, Linear, Polynomial, Power, Step, Video),
    *(FeatureForecast, Last, Mean, Trend, Lifetime, PeriodicRule, PoissonRule, TimesRule),
)
"""The classes of other packages that it may have: mere data."""
_BY_NAME = {(kind.__module__, kind.__qualname__): kind for kind in OTHERS}


class Layout(NamedTuple):
    """How the instances of a class stand in a snapshot.

    A `member` of an enum by its value, a `named` tuple by its elements, others by the values of their `names`; None:
    by all that they have.
    """

    kind: Any
    names: tuple[str, ...] | None = None
    named: bool = False
    member: bool = False


@cache
def layout_of(kind: type) -> Layout:
    """Return the layout of a class. Raises RecordingError for one that no snapshot has."""
    if not (kind.__module__.startswith(CORE) or kind in OTHERS) or issubclass(kind, type | BaseException):
        raise RecordingError(f"a snapshot has no {kind.__module__}.{kind.__qualname__}")
    if issubclass(kind, Enum):
        return Layout(kind, member=True)
    if issubclass(kind, tuple):
        return Layout(kind, tuple(getattr(kind, "_fields", ())), named=True)
    if is_dataclass(kind):
        return Layout(kind, tuple(field.name for field in fields(kind)))
    return Layout(kind, tuple(vars(kind)["__slots__"]) if "__slots__" in vars(kind) else None)


def layout_named(module: str, name: str) -> Layout:
    """Return the layout of the class of this name in a module that is there. Raises RecordingError."""
    found: Any = _BY_NAME.get((module, name))
    if found is None and module.startswith(CORE):
        try:
            found = vars(import_module(module)).get(name)
        except (ImportError, ValueError):
            found = None
    # A module has more than its own classes: what it imports is found where it belongs, or not at all.
    if not isinstance(found, type) or (found.__module__, found.__qualname__) != (module, name):
        raise RecordingError(f"a snapshot has no {module}.{name}"[:200])
    return layout_of(found)


def checked_names(names: Iterable[Any]) -> Iterator[str]:
    """Yield the names of fields; raises RecordingError for what is none."""
    for name in names:
        if not isinstance(name, str) or name.startswith("__"):
            raise RecordingError(f"{name!r:.40} is no field")
        yield name
