"""What the parts of the format are made of: tables of fields, each with its meaning, numbers with their unit."""

from typing import Any

from pydantic import BaseModel, ConfigDict, Field

SECONDS, BYTES, WORTH = "s", "B", "utility·s"
COUNT, SHARE = "count", "share"
"""How many there are; a part of one."""


class Part(BaseModel):
    """A table of the status. What is not described here must not be in it."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


def field(meaning: str, unit: str = "", **options: Any) -> Any:
    """Return the field of a table, for pydantic."""
    return Field(description=meaning, json_schema_extra={"unit": unit} if unit else None, **options)
