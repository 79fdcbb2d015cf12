"""A sample that waits for its decision, as the core sees it: its payload stays with the driver."""

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Waiting:
    """A sample that waits; `priority` is Zenoh's, 1 the highest, `to` the tag of the only robot that a copy is for."""

    sample: int
    key: str
    size: int
    t_gen: float
    scale: float
    priority: int
    markovian: bool
    features: Mapping[str, float] = field(default_factory=dict)
    to: str = ""

    @property
    def worth(self) -> float:
        """Value per byte."""
        return self.scale / max(self.size, 1)
