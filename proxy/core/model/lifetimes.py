"""How long samples are worth anything, by utility: each is measured once."""

import math
from collections.abc import Hashable
from functools import lru_cache
from typing import Any, cast

from planner.utility import MessageUtility
from utility_specs.lifetimes import Lifetime


def worthless_from(utility: MessageUtility) -> float:
    """Return from which age on a sample is worth nothing, or next to nothing [s]; ∞: never."""
    end = _measured(cast("Hashable", utility)).end
    return math.inf if end is None else end


def half_life(utility: MessageUtility) -> float:
    """Return the age at which a sample is worth half of what it was when fresh [s]; ∞: none."""
    found = _measured(cast("Hashable", utility)).half_life
    return math.inf if found is None else found


@lru_cache(maxsize=256)
def _measured(utility: Any) -> Lifetime:
    return Lifetime.of(utility)
