"""A number in a JSON or MessagePack document, as a payload or as an attachment."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import msgpack

from utility_specs.features.feature import Feature
from utility_specs.features.reading import PathTable, Reading
from utility_specs.features.sample import Sample

Format = Literal["json", "msgpack"]


@dataclass(frozen=True, slots=True)
class Document(Feature):
    """What a document has in a place."""

    format: Format
    reading: Reading
    attached: bool = False

    def measure(self, sample: Sample) -> float:
        """Return the number; any exception means that there is none."""
        return self.reading.of(self.document(sample))

    def document(self, sample: Sample) -> Any:
        """Return the document that it is read from; any exception means that there is none."""
        raw = sample.attachment if self.attached else sample.payload
        return sample.once((self.format, self.attached), lambda: _DECODED[self.format](raw))


class JsonTable(PathTable):
    """`{ kind = "json", path = … }`: a value in a JSON document."""

    kind: Literal["json"]

    def feature(self) -> Document:
        """Return the feature that the table describes."""
        return Document("json", self.reading(), default=self.default, budget=self.budget)


class MsgpackTable(PathTable):
    """`{ kind = "msgpack", path = … }`: a value in a MessagePack document."""

    kind: Literal["msgpack"]

    def feature(self) -> Document:
        """Return the feature that the table describes."""
        return Document("msgpack", self.reading(), default=self.default, budget=self.budget)


def _msgpack(raw: bytes) -> Any:
    return msgpack.unpackb(raw, strict_map_key=False, unicode_errors="replace")


_DECODED: Mapping[Format, Callable[[bytes], Any]] = {"json": json.loads, "msgpack": _msgpack}
