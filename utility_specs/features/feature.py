"""What a feature is: one number that is computed from a sample, for scale expressions to use."""

from typing import Annotated, Protocol

from pydantic import BaseModel, ConfigDict, Field

Finite = Annotated[float, Field(allow_inf_nan=False)]


class Feature(Protocol):
    """Computes one number from a sample. `default` stands in when it cannot."""

    @property
    def default(self) -> float:
        """The value when the sample has none."""

    @property
    def reads_payload(self) -> bool:
        """Whether `measure` looks at the payload; when no feature does, nobody copies it."""

    def measure(self, key: str, payload: bytes) -> float:
        """Return the feature's value of a sample. Any exception means: it has none."""


class FeatureTable(BaseModel):
    """What every kind of feature may set in a spec; each kind adds its `kind` and a method `feature()`."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    default: Finite = Field(default=0.0, description="The value of samples that have none.")
