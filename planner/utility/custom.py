"""A value that a Python function computes, from age and features: tabulated once, then as fast as any other."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any, Self

from planner.errors import ProblemError
from planner.utility.base import Floats, Ints, require_above_zero, told_apart
from planner.utility.piecewise import PiecewiseLinear

UtilityFunction = Callable[[Floats, Mapping[str, float]], Any]
"""Gets ages [s] and the features of a message; returns an array with a value >= 0 [1/s] for every age."""

CELLS = 512


@dataclass(frozen=True, slots=True)
class Custom:
    """Straight lines through what `function` returns for `features`, called once, at 513 ages up to `until` [s].

    The ages are `until·(i / 512)^4`: for 60 s they are 4 ms apart at 0.1 s, 22 ms at 1 s, 0.12 s at 10 s.
    The last value holds for all ages from `until` on. A jump becomes a slope between two of these ages. Raises
    ProblemError, which names the function, when that fails or does not return finite numbers >= 0.
    """

    function: UtilityFunction
    features: Mapping[str, float] = field(default_factory=dict, hash=False)
    until: float = 60.0
    curve: PiecewiseLinear = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        require_above_zero("python", "until", self.until)
        ages = self.until * _grid()
        values = self._tabulated(ages)
        curve = PiecewiseLinear.through(ages, values)
        if not curve.finite:
            raise self._problem(f"returns values up to {values.max():g}, too large for a finite integral")
        object.__setattr__(self, "curve", curve)

    @property
    def name(self) -> str:
        """The function, as `package.module:name`."""
        module, name = (getattr(self.function, of, "") for of in ("__module__", "__qualname__"))
        return f"{module}:{name}" if name else repr(self.function)

    def value(self, age: Floats) -> Floats:
        """u(a) for every age [1/s]."""
        return self.curve.value(age)

    def integral(self, start: Floats, end: Floats) -> Floats:
        """∫ u(a) da over [start, end] for every pair of ages, 0 <= start <= end [1]."""
        import numpy as np

        begin, until = _cells(start / self.until), _cells(end / self.until)
        return np.maximum(self.curve.area(until, end) - self.curve.area(begin, start), 0.0)

    @classmethod
    def integrals(cls, utilities: Sequence[Self], which: Ints, start: Floats, end: Floats) -> Floats:
        """∫ of `utilities[which[j]]` over `[start[j], end[j]]` for every j [1]."""
        import numpy as np

        distinct, number = told_apart(utilities)
        of = number[which]
        row = PiecewiseLinear.row([utility.curve for utility in distinct])
        first, scale = of * (CELLS + 1), np.array([utility.until for utility in distinct])[of]
        begin, until = first + _cells(start / scale), first + _cells(end / scale)
        return np.maximum(row.area(until, end) - row.area(begin, start), 0.0)

    def _tabulated(self, ages: Floats) -> Floats:
        """Return the function's values at these ages; it gets copies of all that it could change."""
        import numpy as np

        try:
            with np.errstate(all="ignore"):
                returned = self.function(ages.copy(), dict(self.features))
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            raise self._problem(f"raises {type(error).__name__}: {error}") from error
        if not isinstance(returned, np.ndarray):
            raise self._problem(f"returns a {type(returned).__name__}, not an array with a value for every age")
        if returned.shape != ages.shape:
            raise self._problem(f"returns an array of shape {returned.shape} for ages of shape {ages.shape}")
        if returned.dtype.kind not in "biuf":
            raise self._problem(f"returns an array of {returned.dtype}, not of real numbers")
        values = np.array(returned, dtype=np.float64)
        wrong = np.flatnonzero(~(np.isfinite(values) & (values >= 0.0)))
        if wrong.size:
            at = wrong[0]
            raise self._problem(f"returns {values[at]:g} at the age {ages[at]:g} s, not a finite number >= 0")
        return values

    def _problem(self, what: str) -> ProblemError:
        return ProblemError(f"python utility: {self.name} {what}")


@cache
def _grid() -> Floats:
    """Return the ages at which a function is tabulated, as parts of `until`: the younger, the denser."""
    import numpy as np

    return np.asarray(np.linspace(0.0, 1.0, CELLS + 1) ** 4)


def _cells(age: Floats) -> Ints:
    """Return the last point of the grid that is not after an age (as a part of `until`), up to rounding."""
    import numpy as np

    cells: Ints = (CELLS * np.sqrt(np.sqrt(np.minimum(age, 1.0)))).astype(np.int64)
    return cells
