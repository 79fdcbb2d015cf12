"""Features of samples. Each kind is one file, with its computation and its table, and a word here."""

from typing import Annotated

from pydantic import Field

from utility_specs.features.attachment import AttachmentTable
from utility_specs.features.brightness import BrightnessTable
from utility_specs.features.cdr import CdrTable
from utility_specs.features.change import ChangeTable
from utility_specs.features.color_fraction import ColorFraction, ColorFractionTable
from utility_specs.features.document import JsonTable, MsgpackTable
from utility_specs.features.feature import Feature, FeatureTable
from utility_specs.features.key_chunk import KeyChunkTable
from utility_specs.features.python_function import PythonFunctionTable
from utility_specs.features.sample import AnyPayload, Sample
from utility_specs.features.sharpness import SharpnessTable
from utility_specs.features.size import Size, SizeTable

AnyFeatureTable = Annotated[
    AttachmentTable
    | BrightnessTable
    | CdrTable
    | ChangeTable
    | ColorFractionTable
    | JsonTable
    | KeyChunkTable
    | MsgpackTable
    | PythonFunctionTable
    | SharpnessTable
    | SizeTable,
    Field(discriminator="kind"),
]
"""The table of any kind of feature, told apart by its `kind`."""

__all__ = ["AnyFeatureTable", "AnyPayload", "ColorFraction", "Feature", "FeatureTable", "Sample", "Size"]
