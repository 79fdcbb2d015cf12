"""A sample of another recording."""

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Arrived:
    """A robot published `size` bytes on a key at `t_gen` [s]; `payload` is None where it is not known."""

    t_gen: float
    robot: str
    key: str
    size: int
    features: Mapping[str, float] = field(default_factory=dict)
    payload: bytes | None = None
