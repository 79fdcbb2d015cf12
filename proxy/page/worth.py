"""What a stream is worth now to who watches, and what it would be worth had everything been sent at once."""

from dataclasses import dataclass

import numpy as np

from planner.problem import Aggregation
from planner.utility import MessageUtility
from proxy.page.tuning import TUNING
from proxy.quantities import Status
from utility_specs import InformationType, Specs


@dataclass(frozen=True, slots=True)
class Worth:
    """The worth of a stream `now`, and `most`, had each sample arrived when it was made [utility]."""

    now: float
    most: float


def worth(specs: Specs, stream: Status) -> Worth | None:
    """Return what the newest sample that is there is worth, by what a status says of its stream (MODEL.md 3).

    None where that is not known: no type covers it, each of its samples counts and not the newest alone, nobody wants
    it, or its daemon does not tell what is needed.
    """
    kind, newest, made = specs.match(str(stream.get("key"))), stream.get("scale"), stream.get("last_generated")
    if kind is None or not kind.markovian or newest is None or made is None or not stream.get("receivers"):
        return None
    utility = kind.utility_of({})
    most = newest * _at(utility, made)
    shown, age = stream.get("shown"), stream.get("age")
    if shown is None or age is None:
        return Worth(0.0, most)
    now = shown * _at(utility, age)
    if kind.aggregation is Aggregation.CURRENT:
        now -= _at(utility, 0.0) * max(0.0, shown - newest)
    return Worth(now, max(now, most))


def marked(specs: Specs, stream: Status) -> bool:
    """Whether the newest sample of a stream is worth much more than a usual one of its type."""
    kind, newest = specs.match(str(stream.get("key"))), stream.get("scale")
    return kind is not None and newest is not None and newest >= TUNING.marked * _usual(kind) > 0.0


def _usual(kind: InformationType) -> float:
    return kind.scale(kind.completed({}))


def _at(utility: MessageUtility, age: float) -> float:
    return float(utility.value(np.array([max(0.0, age)]))[0])
