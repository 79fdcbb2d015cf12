"""What operators may call their information types and constraints, and what expressions are about."""

import keyword
import re
from typing import Annotated

from pydantic import AfterValidator

from utility_specs.expressions import CONSTANTS, FUNCTIONS
from utility_specs.suggestions import described


def _name(name: str) -> str:
    if not re.fullmatch(r"\w[\w .-]{0,63}", name):
        raise ValueError(f"must be 1 to 64 letters, digits, spaces, dots, - or _, not {described(name)}")
    return name


def variable(name: str, what: str) -> str:
    """Return the name of `what` expressions may use; raises ValueError for one that they cannot."""
    if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]{0,63}", name):
        raise ValueError(f"a {what}'s name must be letters, digits and _, and not begin with a digit")
    if name in CONSTANTS or name in FUNCTIONS or keyword.iskeyword(name):
        raise ValueError(f"this name has a meaning in expressions; choose another one for the {what}")
    return name


Name = Annotated[str, AfterValidator(_name)]
"""A name that stands well in a line of text."""

FeatureName = Annotated[str, AfterValidator(lambda name: variable(name, "feature"))]
ConstantName = Annotated[str, AfterValidator(lambda name: variable(name, "constant"))]
