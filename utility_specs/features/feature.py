"""What a feature is: one number that is computed from a sample, for scale expressions to use."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import ClassVar

from pydantic import BaseModel, ConfigDict, Field

from utility_specs.features.sample import Sample
from utility_specs.units import Duration

BUDGET = 0.02
"""What a feature may take for a sample on average unless its spec says otherwise [s]."""


@dataclass(frozen=True, slots=True)
class Feature(ABC):
    """Computes one number from a sample. `default` stands in when it cannot; `budget` is what it may take [s]."""

    default: float = field(default=0.0, kw_only=True)
    budget: float = field(default=BUDGET, kw_only=True)

    reads_payload: ClassVar[bool] = True
    """Whether `measure` looks at more than the key; when no feature does, nobody copies the payload."""
    ends: ClassVar[bool] = True
    """Whether `measure` surely comes to an end: a function of an operator's own may not."""

    @abstractmethod
    def measure(self, sample: Sample) -> float:
        """Return the feature's value of a sample. Any exception means: it has none."""


class FeatureTable(BaseModel):
    """What every kind of feature may set in a spec; each kind adds its `kind` and what `feature()` makes of it."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)

    default: float = Field(default=0.0, description="The value of samples that have none.")
    budget: Duration = Field(
        default=BUDGET,
        description="What computing it may take for a sample on average; what takes longer is computed less often.",
    )

    @abstractmethod
    def feature(self) -> Feature:
        """Return the feature that the table describes."""
