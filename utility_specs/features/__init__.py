"""Features of samples. Each kind is one file, with its computation and its table, and a word here."""

from typing import Annotated

from pydantic import Field

from utility_specs.features.color_fraction import ColorFraction, ColorFractionTable
from utility_specs.features.feature import Feature, FeatureTable
from utility_specs.features.size import Size, SizeTable

AnyFeatureTable = Annotated[ColorFractionTable | SizeTable, Field(discriminator="kind")]
"""The table of any kind of feature, told apart by its `kind`."""

__all__ = ["AnyFeatureTable", "ColorFraction", "Feature", "FeatureTable", "Size"]
