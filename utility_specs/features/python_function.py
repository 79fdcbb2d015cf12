"""What a Python function says of a sample: `{ kind = "python", function = "package.module:name" }`."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from pydantic import Field, field_validator

from utility_specs.features.feature import Feature, FeatureTable
from utility_specs.features.sample import Sample
from utility_specs.imports import imported


@dataclass(frozen=True, slots=True)
class PythonFunction(Feature):
    """What the function returns for key and payload."""

    ends: ClassVar[bool] = False

    function: Callable[[str, bytes], Any]

    def measure(self, sample: Sample) -> float:
        """Return what the function returns; raises whatever the function raises."""
        return float(self.function(sample.key, sample.payload))


class PythonFunctionTable(FeatureTable):
    """`{ kind = "python", function = … }`: what a function returns for key and payload."""

    kind: Literal["python"]
    function: str = Field(description="The import path of the function: package.module:name.")

    @field_validator("function")
    @classmethod
    def _importable(cls, path: str) -> str:
        imported(path)
        return path

    def feature(self) -> PythonFunction:
        """Return the feature that the table describes."""
        return PythonFunction(imported(self.function), default=self.default, budget=self.budget)
