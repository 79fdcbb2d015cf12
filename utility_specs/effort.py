"""What judging a file may take: who has made a mistake wants to know at once, and the first ones will do."""

from typing import Any

from pydantic import BeforeValidator, ValidationError, ValidationInfo, ValidatorFunctionWrapHandler, WrapValidator
from pydantic_core import PydanticCustomError, PydanticKnownError

ENOUGH = 20
"""Tables and numbers of a file with mistakes in them; when there are so many, the others are not judged."""
UNJUDGED = "unjudged"
"""The type of the errors that stand for those."""
MOST_TEXT = 16 * 1024
"""Characters of all expressions of a file together; a few hundred long ones have that."""


def _judged(value: Any, judge: ValidatorFunctionWrapHandler, info: ValidationInfo) -> Any:
    if info.context is None:
        return judge(value)
    if info.context.get("wrong", 0) >= ENOUGH:
        raise PydanticCustomError(UNJUDGED, "is not judged")
    try:
        return judge(value)
    except ValidationError:
        info.context["wrong"] = info.context.get("wrong", 0) + 1
        raise


Sparingly = WrapValidator(_judged)
"""Judges an item of a table or an array, unless enough of its file are known to be wrong."""


def at_most(most: int) -> BeforeValidator:
    """Return what refuses a table or an array with more items before it judges any."""

    def few(value: Any) -> Any:
        if isinstance(value, dict | list) and len(value) > most:
            kind = "Dictionary" if isinstance(value, dict) else "List"
            raise PydanticKnownError("too_long", {"field_type": kind, "max_length": most, "actual_length": len(value)})
        return value

    return BeforeValidator(few)


def read(text: str, info: ValidationInfo) -> None:
    """Count an expression of the file; raises ValueError when all together are too long."""
    if info.context is not None:
        info.context["text"] = info.context.get("text", 0) + len(text)
        if info.context["text"] > MOST_TEXT:
            raise ValueError(f"the expressions of this file have more than {MOST_TEXT} characters in all")
