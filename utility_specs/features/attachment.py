"""A number in the attachment of a sample: `{ kind = "attachment", format = "json", path = "priority" }`."""

import struct
from dataclasses import dataclass
from typing import Literal, Self

from pydantic import Field, model_validator

from utility_specs.features.document import Document, Format
from utility_specs.features.feature import Feature
from utility_specs.features.reading import PathTable
from utility_specs.features.sample import Sample

Raw = Literal["int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64"]

_CODES: dict[Raw, str] = dict(
    zip(
        ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64"),
        "bBhHiIqQfd",
        strict=True,
    )
)


@dataclass(frozen=True, slots=True)
class RawNumber(Feature):
    """The number whose bytes stand at an offset in the attachment; `code` is that of `struct`."""

    code: str
    offset: int

    def measure(self, sample: Sample) -> float:
        """Return the number; raises struct.error where the attachment is too short."""
        return float(struct.unpack_from(self.code, sample.attachment, self.offset)[0])


class AttachmentTable(PathTable):
    """`{ kind = "attachment", format = … }`: a value in the attachment of a sample."""

    kind: Literal["attachment"]
    format: Literal[Format, Raw] = Field(description="What the attachment is: a document, or a number's bytes.")
    offset: int = Field(default=0, ge=0, le=2**31 - 1, description="Where the bytes of the number begin [B].")
    byte_order: Literal["little", "big"] = Field(default="little", description="Which byte of the number comes first.")

    @model_validator(mode="after")
    def _fitting(self) -> Self:
        odd = {"path", "equals", "reduce"} if self.format in _CODES else {"offset", "byte_order"}
        for key in sorted(odd & self.model_fields_set):
            raise ValueError(f'{key} has no meaning with format = "{self.format}"')
        return self

    def feature(self) -> Feature:
        """Return the feature that the table describes."""
        if self.format == "json" or self.format == "msgpack":  # noqa: PLR1714 - so that mypy follows
            return Document(self.format, self.reading(), attached=True, default=self.default, budget=self.budget)
        code = ("<" if self.byte_order == "little" else ">") + _CODES[self.format]
        return RawNumber(code, self.offset, default=self.default, budget=self.budget)
