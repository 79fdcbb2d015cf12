"""A feature of Zenoh: a probe that shows what applications see of it, and in what it is known to differ."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

Transcript = dict[str, Any]
"""What applications saw, by the name of the observation; plain data that is the same in every run."""


@dataclass(frozen=True)
class Limit:
    """One observation that differs between two routers and two daemons, what both are, and why."""

    observation: str
    routers: Any
    daemons: Any
    reason: str

    @property
    def difference(self):
        """What must be found, exactly."""
        return self.observation, self.routers, self.daemons


class Bug(Limit):
    """A difference that is to go. Once it is gone its test fails until this entry is removed."""


@dataclass(frozen=True)
class Feature:
    """One row of the table. `probe` gets a team and returns a transcript."""

    group: str
    name: str
    compared: str
    probe: Callable[[Any], Transcript]
    limits: tuple[Limit, ...]


FEATURES: list[Feature] = []
"""All features, in the order of the table."""


def feature(group, name, *limits):
    """Add the probe below to the table; its docstring says what is compared."""

    def add(probe):
        FEATURES.append(Feature(group, name, " ".join(probe.__doc__.split()).rstrip("."), probe, limits))
        return probe

    return add


def differences(routers, daemons):
    """Where two transcripts differ: observation, and what each has there."""
    names = list(dict.fromkeys([*routers, *daemons]))
    pairs = ((name, routers.get(name), daemons.get(name)) for name in names)
    return [(name, one, other) for name, one, other in pairs if one != other]
