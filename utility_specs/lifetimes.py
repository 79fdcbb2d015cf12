"""How a message utility goes by: its value when fresh, its half life, and when it is over."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np

from planner.utility import Floats, Ints, MessageUtility, Power

LONGEST = 86_400.0
"""What has a value at this age [s] is said to last for ever."""
YOUNG = 1e-3
"""The age [s] at which a message is said to be fresh where the value at 0 is infinite."""
LITTLE = 0.01
"""A message is said to be over when it is worth this part of its greatest value for good."""

_AGES = np.concatenate([[0.0], np.geomspace(YOUNG / 10.0, LONGEST, 6000)])


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
        values = utility.value(_AGES)
        young = YOUNG if isinstance(utility, Power) else 0.0
        fresh = _at(utility, young)
        peak = max(fresh, float(values[_AGES >= YOUNG].max()))
        below = np.flatnonzero((values < fresh / 2.0) & (young <= _AGES))
        above = np.flatnonzero(values > LITTLE * peak)
        lasts = above.size > 0 and above[-1] == len(_AGES) - 1
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


def integral(utility: MessageUtility, until: float) -> float:
    """Return what a message is worth up to an age [s] to one who has it from the start [1]."""
    return float(utility.integral(np.zeros(1), np.full(1, until))[0])


def sampled(utility: MessageUtility, start: float, until: float, count: int) -> Floats:
    """Return the values at so many ages at equal distances."""
    return utility.value(np.linspace(start, until, count))


def _at(utility: MessageUtility, age: float) -> float:
    return float(utility.value(np.full(1, age))[0])


def _end(utility: MessageUtility, above: Ints, little: float) -> float:
    """Return from when on the values are little, or when they are 0 if that is soon after."""
    if not above.size:
        return 0.0
    end = _crossing(lambda age: _at(utility, age) <= little, int(above[-1]) + 1)
    last = np.flatnonzero(utility.value(_AGES))[-1] + 1
    over = _crossing(lambda age: _at(utility, age) <= 0.0, int(last)) if last < len(_AGES) else LONGEST
    return over if over <= 2.0 * end else end


def _crossing(holds: Callable[[float], bool], place: int) -> float:
    """Return the age at which something begins to hold that holds at a place of the grid and not before it."""
    low, high = float(_AGES[max(place - 1, 0)]), float(_AGES[place])
    for _ in range(50):
        middle = (low + high) / 2.0
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high
