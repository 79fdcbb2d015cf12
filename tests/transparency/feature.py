"""A feature of Zenoh: a probe that shows what applications see of it, and in what it is known to differ."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

Transcript = dict[str, Any]
"""What applications saw, by the name of the observation; plain data that is the same in every run."""


@dataclass(frozen=True, eq=False)
class Limit:
    """Why observations differ; of each what it is with two routers and with two daemons, exactly."""

    reason: str
    differs: Mapping[str, tuple[Any, Any]]


class Bug(Limit):
    """A difference that is to go. When it is gone the test of its feature fails until this entry is removed."""


@dataclass(frozen=True, eq=False)
class Feature:
    """One row of the table. `probe` gets a team and returns a transcript; its docstring says what is compared."""

    group: str
    name: str
    probe: Callable[[Any], Transcript]
    limits: tuple[Limit, ...]

    @property
    def compared(self):
        """What is compared, in words."""
        return " ".join(self.probe.__doc__.split()).rstrip(".")

    def look(self, team):
        """Run the probe; return its transcript as it would be written."""
        return json.loads(json.dumps(self.probe(team)))

    @property
    def known(self):
        """The differences between routers and daemons that are known."""
        return {
            name: (json.loads(json.dumps(routers)), json.loads(json.dumps(daemons)))
            for limit in self.limits
            for name, (routers, daemons) in limit.differs.items()
        }


FEATURES: list[Feature] = []
"""All features, in the order of the table."""


def feature(group, name, *limits):
    """Add the probe below to the table; its docstring says what is compared."""

    def add(probe):
        FEATURES.append(Feature(group, name, probe, limits))
        return probe

    return add


def differences(one, other):
    """Where two transcripts differ: by observation what each has there."""
    names = dict.fromkeys([*one, *other])
    return {name: (one.get(name), other.get(name)) for name in names if one.get(name) != other.get(name)}
