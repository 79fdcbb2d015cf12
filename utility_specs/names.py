"""What operators may call their information types and constraints."""

import re
from typing import Annotated

from pydantic import AfterValidator

from utility_specs.suggestions import described


def _name(name: str) -> str:
    if not re.fullmatch(r"\w[\w .-]{0,63}", name):
        raise ValueError(f"must be 1 to 64 letters, digits, spaces, dots, - or _, not {described(name)}")
    return name


Name = Annotated[str, AfterValidator(_name)]
"""A name that stands well in a line of text."""
