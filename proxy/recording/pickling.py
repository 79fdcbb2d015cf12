"""The core as bytes: a pickle of which `unpickling.py` reads as much as stands here, and no more.

Pickle writes a core of 500 streams in 20 ms, in which the loop stands still; anything written in Python takes ten
times as long. How objects of a class are taken apart is found out once for each class: as pickle does it by itself it
takes twice as long.
"""

import gc
from collections import Counter, deque
from collections.abc import Callable
from copyreg import __newobj__ as new  # type: ignore[attr-defined]
from io import BytesIO
from operator import attrgetter
from pickle import Pickler as _Pickler
from pickle import PicklingError
from types import MappingProxyType
from typing import Any

from proxy.core.core import Core
from proxy.recording.errors import RecordingError
from proxy.recording.layouts import Layout, layout_of
from proxy.recording.spec_parts import SpecParts
from utility_specs import InformationType, Specs
from utility_specs.specs import Failures

UTILITIES = "planner.utility."
"""What the modules of all utilities begin with."""
Reduce = Callable[[Any], tuple[Any, ...]]
"""Takes an object apart, as `object.__reduce__` does."""


def part(*place: Any) -> Any:
    """Stand for a part of the specs in a snapshot."""
    raise NotImplementedError(f"only a snapshot has {place}")


def view(*table: Any) -> Any:
    """Stand for a read-only view of a table."""
    raise NotImplementedError(f"only a snapshot has {table}")


def pickled(core: Core) -> bytes:
    """Return a core with all that it knows. On the thread on which it is used. Raises RecordingError."""
    buffer = BytesIO()
    pickler = _Pickler(buffer, protocol=5)
    pickler.dispatch_table = _Reducers(SpecParts(core.view.specs))
    collects = gc.isenabled()
    gc.disable()  # a pickle is 100,000 objects that stay until it is there: to look for garbage among them takes 5 ms
    try:
        pickler.dump(core)
    except (PicklingError, AttributeError, TypeError, RecursionError) as error:
        raise RecordingError(f"{type(error).__name__}: {error}") from None
    finally:
        if collects:
            gc.enable()
    return buffer.getvalue()


class _Reducers(dict[type, Reduce]):
    """How objects are taken apart, by class."""

    def __init__(self, parts: SpecParts) -> None:
        super().__init__()
        self._parts = parts
        self[deque] = lambda o: (deque, ((), o.maxlen), None, iter(o))
        self[Counter] = lambda o: (Counter, (), None, None, iter(o.items()))
        self[MappingProxyType] = lambda o: (view, (dict(o),))
        self[Specs] = self[InformationType] = self[Failures] = self._of_specs

    def __missing__(self, kind: type) -> Reduce:
        if issubclass(kind, type):
            raise KeyError(kind)
        self[kind] = self._reduce(kind)
        return self[kind]

    def _of_specs(self, whole: Any) -> tuple[Any, ...]:
        return part, self._parts.place(whole)

    def _reduce(self, kind: type) -> Reduce:
        try:
            by_layout = _by_layout(layout_of(kind))
        except RecordingError:  # then it is an operator's, or it is no part of specs
            return self._foreign
        if not kind.__module__.startswith(UTILITIES):
            return by_layout

        def utility(whole: Any) -> tuple[Any, ...]:
            place = self._parts.place(whole)
            return (part, place) if isinstance(place[0], int) else by_layout(whole)

        return utility

    def _foreign(self, whole: Any) -> tuple[Any, ...]:
        place = self._parts.place(whole)
        if not isinstance(place[0], int) and not type(whole).__module__.startswith(UTILITIES):
            layout_of(whole.__class__)
        return part, place


def _by_layout(layout: Layout) -> Reduce:
    kind, names, of = layout.kind, layout.names, (layout.kind,)
    if layout.member:
        return lambda o: (kind, (o.value,))
    if layout.named:
        return lambda o: (new, (kind, *o))
    if names is None:
        return lambda o: (new, of, o.__getstate__())
    if len(names) == 1:
        return lambda o: (new, of, (getattr(o, names[0]),))
    values = attrgetter(*names) if names else lambda _: ()
    return lambda o: (new, of, values(o))
