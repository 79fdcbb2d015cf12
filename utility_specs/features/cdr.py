"""A number in a message of ROS 2: `{ kind = "cdr", type = "sensor_msgs/msg/BatteryState", field = "percentage" }`."""

from dataclasses import dataclass
from pathlib import Path as File
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, Field, ValidationInfo, field_validator, model_validator

from utility_specs.features.feature import Feature
from utility_specs.features.path import Path, many, steps_of
from utility_specs.features.reading import Reading, ReadingTable, needs_reduce, reading
from utility_specs.features.ros_types import Distro, check_number, field_of, typestore
from utility_specs.features.sample import Sample
from utility_specs.suggestions import quoted
from utility_specs.toml_source import is_no_file

LARGEST_DEFINITION = 64 * 1024
"""Bytes of the largest message definition that is read."""


@dataclass(frozen=True, slots=True)
class Cdr(Feature):
    """What a message of a type has in a field; `store` is rosbags' of the type."""

    store: Any
    type: str
    reading: Reading

    def measure(self, sample: Sample) -> float:
        """Return the number; any exception means that there is none."""
        what = (id(self.store), self.type)
        return self.reading.of(sample.once(what, lambda: self.store.deserialize_cdr(sample.payload, self.type)))


def _type(name: str) -> str:
    """Return the full name of a type, which people often write without `msg`."""
    parts = name.split("/")
    if len(parts) not in {2, 3} or not all(parts):
        raise ValueError(f'{quoted(name)} is not a type; write for example "sensor_msgs/msg/BatteryState"')
    return "/".join(parts if len(parts) == 3 else (parts[0], "msg", parts[1]))


def _definition(written: str, info: ValidationInfo) -> str:
    """Return the text of a file beside the spec, or what is written if it has lines: it is a part of the specs."""
    if "\n" in written:
        return written
    path = File((info.context or {}).get("folder", "."), written)
    try:
        if is_no_file(path):
            raise ValueError("it is not a file")  # noqa: TRY301 - like all that may be wrong with it
        with path.open("rb") as opened:
            text = opened.read(LARGEST_DEFINITION + 1).decode()
    except (OSError, ValueError) as error:
        raise ValueError(f"cannot read {quoted(str(path))}: {getattr(error, 'strerror', None) or error}") from None
    if len(text) > LARGEST_DEFINITION:
        raise ValueError(f"{quoted(str(path))} is larger than {LARGEST_DEFINITION // 1024} KiB")
    return text


class CdrTable(ReadingTable):
    """`{ kind = "cdr", type = …, field = … }`: a value in a message of ROS 2."""

    kind: Literal["cdr"]
    distro: Distro = Field(default="jazzy", description="The distribution of ROS 2 whose messages these are.")
    definition: Annotated[str, AfterValidator(_definition)] | None = Field(
        default=None, description="The definition of a type of your own: a .msg file beside the spec, or its text."
    )
    type: Annotated[str, AfterValidator(_type)] = Field(description="Such as sensor_msgs/msg/BatteryState.")
    field: Path = Field(description="Where the value is in the message, such as pose.position.x.")

    @field_validator("type")
    @classmethod
    def _known(cls, name: str, info: ValidationInfo) -> str:
        if {"distro", "definition"} <= info.data.keys():  # else they have problems of their own
            typestore(info.data["distro"], name, info.data["definition"])
        return name

    @field_validator("field")
    @classmethod
    def _of_the_type(cls, field: str, info: ValidationInfo) -> str:
        if "type" in info.data and {"distro", "definition"} <= info.data.keys():
            store = typestore(info.data["distro"], info.data["type"], info.data["definition"])
            found = field_of(store, info.data["type"], steps_of(field))
            if not many(steps_of(field)):  # or it must be reduced: below
                check_number(found, compared=info.data.get("equals") is not None, reduction=info.data.get("reduce"))
        return field

    @model_validator(mode="after")
    def _reduced(self) -> Self:
        needs_reduce(self.field, self)
        return self

    def feature(self) -> Cdr:
        """Return the feature that the table describes."""
        store = typestore(self.distro, self.type, self.definition)
        return Cdr(store, self.type, reading(self.field, self), default=self.default, budget=self.budget)
