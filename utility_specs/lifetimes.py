"""How a message utility goes by: its value when fresh, its half life, and when it is over."""

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any, Self, cast

from planner.utility import Floats, Ints, MessageUtility, Power, integral

LONGEST = 86_400.0
"""What has a value at this age [s] is said to last for ever."""
YOUNG = 1e-3
"""The age [s] at which a message is said to be fresh where the value at 0 is infinite."""
LITTLE = 0.01
"""A message is said to be over when it is worth this part of its greatest value for good."""


@dataclass(frozen=True, slots=True)
class Lifetime:
    """Ages [s] and values [1/s] of a message utility that say what is meant by it.

    `fresh` is the value at the age `young`, which is 0 unless the value there is infinite. `half_life` is when it
    first falls below half of that, `end` when it is 0 for good, or less than 1 % of its greatest value long before;
    None: never. `rest` is the value from `end` on. `total` is the integral over all ages [1]; None: without end.
    """

    young: float
    fresh: float
    half_life: float | None
    end: float | None
    rest: float
    first_second: float
    total: float | None

    @classmethod
    def of(cls, utility: MessageUtility) -> Self:
        """Measure a utility."""
        import numpy as np

        ages = _ages()
        values = utility.value(ages)
        young = YOUNG if isinstance(utility, Power) else 0.0
        fresh = _at(utility, young)
        peak = max(fresh, float(values[ages >= YOUNG].max()))
        below = np.flatnonzero((values < fresh / 2.0) & (young <= ages))
        above = np.flatnonzero(values > LITTLE * peak)
        lasts = above.size > 0 and above[-1] == len(ages) - 1
        half_life = _crossing(lambda age: _at(utility, age) < fresh / 2.0, int(below[0])) if below.size else None
        end = None if lasts else _end(utility, above, LITTLE * peak)
        rest = _at(utility, LONGEST if end is None else end * (1.0 + 1e-6))
        return cls(
            young,
            fresh,
            half_life,
            end,
            rest,
            integral(utility, 1.0),
            None if end is None else integral(utility, LONGEST),
        )

    @property
    def shown(self) -> float:
        """The age up to which a plot shows all that matters [s]."""
        if self.end is not None:
            return 1.05 * self.end or 1.0
        return 60.0 if self.half_life is None else max(1.0, 10.0 * self.half_life)


def initial(utility: MessageUtility) -> float:
    """Return the value at the age 0 [1/s]; it is kept, for each decision asks for it."""
    return _initial(cast("Hashable", utility))


@lru_cache(maxsize=256)
def _initial(utility: Any) -> float:
    return _at(utility, 0.0)


def sampled(utility: MessageUtility, start: float, until: float, count: int) -> Floats:
    """Return the values at so many ages at equal distances."""
    import numpy as np

    return utility.value(np.linspace(start, until, count))


@cache
def _ages() -> Floats:
    """Return the ages at which a utility is looked at [s]."""
    import numpy as np

    return np.concatenate([[0.0], np.geomspace(YOUNG / 10.0, LONGEST, 6000)])


def _at(utility: MessageUtility, age: float) -> float:
    import numpy as np

    return float(utility.value(np.full(1, age))[0])


def _end(utility: MessageUtility, above: Ints, little: float) -> float:
    """Return from when on the values are little, or when they are 0 if that is soon after."""
    import numpy as np

    if not above.size:
        return 0.0
    end = _crossing(lambda age: _at(utility, age) <= little, int(above[-1]) + 1)
    last = np.flatnonzero(utility.value(_ages()))[-1] + 1
    over = _crossing(lambda age: _at(utility, age) <= 0.0, int(last)) if last < len(_ages()) else LONGEST
    return over if over <= 2.0 * end else end


def _crossing(holds: Callable[[float], bool], place: int) -> float:
    """Return the age at which something begins to hold that holds at a place of the grid and not before it."""
    ages = _ages()
    low, high = float(ages[max(place - 1, 0)]), float(ages[place])
    for _ in range(50):
        middle = (low + high) / 2.0
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high
