"""What an operator writes: utility specs, their schema, features of samples, specs to start from."""

from utility_specs.errors import SpecProblem, SpecsError
from utility_specs.forecast import FeatureForecast
from utility_specs.loader import load_specs
from utility_specs.specs import ConstraintSpec, InformationType, Specs

__all__ = [
    "ConstraintSpec",
    "FeatureForecast",
    "InformationType",
    "SpecProblem",
    "Specs",
    "SpecsError",
    "load_specs",
]
