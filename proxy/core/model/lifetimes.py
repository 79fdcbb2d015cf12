"""How long samples are worth anything, by utility: each is measured once."""

import math

from planner.utility import MessageUtility
from proxy.core.model.tuning import TUNING
from utility_specs.lifetimes import Lifetime


class Lifetimes:
    """The lifetimes of utilities that were asked for."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[MessageUtility, Lifetime]] = {}

    def __getstate__(self) -> dict[str, object]:
        """Leave out what is known by identity, which is another one elsewhere."""
        return {"_known": {}}

    def end(self, utility: MessageUtility) -> float:
        """Return from which age on a sample is worth nothing, or next to nothing [s]; ∞: never."""
        end = self._of(utility).end
        return math.inf if end is None else end

    def half_life(self, utility: MessageUtility) -> float:
        """Return the age at which a sample is worth half of what it was when fresh [s]; ∞: none."""
        half_life = self._of(utility).half_life
        return math.inf if half_life is None else half_life

    def _of(self, utility: MessageUtility) -> Lifetime:
        known = self._known.get(id(utility))
        if known is None:
            if len(self._known) >= TUNING.utilities:
                self._known.clear()
            known = self._known[id(utility)] = utility, Lifetime.of(utility)
        return known[1]
