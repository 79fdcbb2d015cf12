"""What the channel bore when a recording was made: a replay has none that adaptive limits could follow.

Each daemon tells in its digests what part of the ceiling of every adaptive limit the channel bears; the mean of that
over time is taken for a fixed limit.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from planner.airtime import Airtime
from planner.measures import Measure, Throughput
from studies.replay.errors import ReplayError
from utility_specs import ConstraintSpec, Specs

LONGEST = 10.0
"""What a digest says holds for so long at most, should no other one be recorded [s]."""


@dataclass(slots=True)
class Part:
    """The part of its ceiling that a limit was, over time."""

    least: float = 1.0
    most: float = 0.0
    _sum: float = 0.0
    _seconds: float = 0.0

    def note(self, part: float, seconds: float) -> None:
        """It was so much for so long."""
        self.least, self.most = min(self.least, part), max(self.most, part)
        self._sum += part * seconds
        self._seconds += seconds

    @property
    def mean(self) -> float:
        """Over time; the least where there was none."""
        return self._sum / self._seconds if self._seconds else self.least


@dataclass(slots=True)
class Borne:
    """What the channel bore of each adaptive limit, as all robots of a recording found."""

    parts: list[Part] = field(default_factory=list)
    _last: dict[str, tuple[float, tuple[float, ...]]] = field(default_factory=dict)

    def note(self, robot: str, now: float, command: Mapping[str, Any]) -> None:
        """Take in what a robot asked for [s]."""
        digest = command.get("digest")
        told = digest.get("capacity") if isinstance(digest, Mapping) else None
        if not isinstance(told, list) or not told or not all(_is_part(each) for each in told):
            return
        since, before = self._last.get(robot, (now, ()))
        self._last[robot] = now, tuple(map(float, told))
        self.parts += [Part() for _ in range(len(told) - len(self.parts))]
        for part, at_first in zip(self.parts, before or told, strict=False):
            part.note(at_first, min(max(0.0, now - since), LONGEST))


def as_borne(specs: Specs, borne: Borne, recorded: Specs | None = None) -> tuple[Specs, list[str]]:
    """Return specs whose adaptive limits are fixed at what the channel bore in the mean, and what to say of that.

    What it bore is told in parts of the ceilings of the `recorded` specs, if they are others. Raises ReplayError where
    it is not known.
    """
    adaptive, before = _adaptive(specs), _adaptive(specs if recorded is None else recorded)
    if not adaptive:
        return specs, []
    if not len(borne.parts) == len(adaptive) == len(before):
        raise ReplayError(
            f"the limit {adaptive[0].name} is adaptive, and nothing in the recording says what the channel bore of it:"
            " --limit names a throughput instead, or --specs other specs"
        )
    fixed, notes = list[ConstraintSpec](), list[str]()
    parts = zip(borne.parts, before, strict=True)
    for spec in specs.constraints:
        if spec.least < 1.0:
            part, then = next(parts)
            ratio = _ratio(then, spec)
            mean, *ends = (min(1.0, ratio * each) for each in (part.mean, part.least, part.most))
            fixed.append(ConstraintSpec(spec.name, _scaled(spec.measure, mean)))
            percent = [f"{100 * each:.0f}" for each in (mean, *ends)]
            notes.append(
                f"the limit {spec.name} was adaptive, and is fixed here at the {percent[0]} % of its ceiling that the"
                f" channel bore in the mean ({percent[1]} to {percent[2]} %)"
            )
        else:
            fixed.append(spec)
    return replace(specs, constraints=tuple(fixed), generation=f"{specs.generation}+fixed"), notes


def _adaptive(specs: Specs) -> list[ConstraintSpec]:
    return [spec for spec in specs.constraints if spec.least < 1.0]


def _ratio(recorded: ConstraintSpec, now: ConstraintSpec) -> float:
    """Return how many times its ceiling now the recorded one of a limit was. Raises ReplayError for another kind."""
    match recorded.measure, now.measure:
        case Throughput() as before, Throughput() as here:
            return before.rate / here.rate
        case Airtime() as before, Airtime() as here:
            return before.fraction / here.fraction
    raise ReplayError(
        f"the limit {now.name} is adaptive, and what the channel bore was recorded of one of {recorded.measure.kind}:"
        " --limit names a throughput instead, or --specs other specs"
    )


def _scaled(measure: Measure, part: float) -> Measure:
    """Return the limit of which the given one is the ceiling."""
    match measure:
        case Throughput():
            return replace(measure, rate=part * measure.rate)
        case Airtime():
            return replace(measure, fraction=part * measure.fraction)
    raise ReplayError(f"an adaptive limit of {measure.kind} cannot be flown anew: --specs names other specs")


def _is_part(value: object) -> bool:
    return isinstance(value, float | int) and 0.0 < value <= 1.0
