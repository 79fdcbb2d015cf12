"""Ready-made rules for what may leave the robot: the files in `profiles/`, chosen with `[bridge] profile`."""

import tomllib
from pathlib import Path

from pydantic import Field

from proxy.config import Section
from proxy.config_values import KeyExpressions

FOLDER = Path(__file__).with_name("profiles")


class InLists(Section):
    """`[in]` of a profile: key expressions that are denied."""

    deny: KeyExpressions = ()


class OutLists(Section):
    """`[out]` of a profile: key expressions that are denied, and those whose samples bypass the planner."""

    deny: KeyExpressions = ()
    bypass: KeyExpressions = ()


class Profile(Section):
    """What a profile adds to the lists of the configuration."""

    out: OutLists = OutLists()
    into: InLists = Field(default=InLists(), alias="in")


def load_profile(name: str) -> Profile:
    """Return the profile of that name; "none" is empty."""
    if name == "none":
        return Profile()
    return Profile.model_validate(tomllib.loads((FOLDER / f"{name}.toml").read_text(encoding="utf-8")))
