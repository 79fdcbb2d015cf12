"""A number in the key: `{ kind = "key_chunk", index = 1 }` is 7 for `robot/7/camera` and for `robot/r7/camera`."""

import re
from contextlib import suppress
from dataclasses import dataclass
from typing import ClassVar, Literal

from pydantic import Field

from utility_specs.errors import FeatureError
from utility_specs.features.feature import Feature, FeatureTable
from utility_specs.features.sample import Sample

_NUMBERS = re.compile(r"\d+(?:\.\d+)?", re.ASCII)


MOST = 65_535
"""More chunks than any key has."""


@dataclass(frozen=True, slots=True)
class KeyChunk(Feature):
    """The number in the chunk with an index, which counts from 0, or from the end where it is negative."""

    index: int

    reads_payload: ClassVar[bool] = False

    def measure(self, sample: Sample) -> float:
        """Return the number; raises FeatureError where the chunk has none or several, IndexError without chunk."""
        chunk = sample.key.split("/")[self.index]
        if chunk.isascii() and "_" not in chunk:  # Python reads 1_2 and digits of other scripts, too
            with suppress(ValueError):
                return float(chunk)  # 1e3 and the like
        numbers = _NUMBERS.findall(chunk)
        if len(numbers) != 1:
            raise FeatureError(f"{sample.key}: {chunk} has {len(numbers)} numbers in it")
        return float(numbers[0])


class KeyChunkTable(FeatureTable):
    """`{ kind = "key_chunk", index = … }`: the number in a chunk of the key."""

    kind: Literal["key_chunk"]
    index: int = Field(ge=-MOST, le=MOST, description="Which chunk, from 0 on; -1 is the last.")

    def feature(self) -> KeyChunk:
        """Return the feature that the table describes."""
        return KeyChunk(self.index, default=self.default, budget=self.budget)
