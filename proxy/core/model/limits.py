"""What the constraints of the specs leave for messages, and what a message uses of them."""

import math
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from planner import Constraint
from planner.measures import Measure
from proxy.core.model.tuning import TUNING
from utility_specs import ConstraintSpec, Specs
from utility_specs.digests import LEAST_RATE, least_use, left_by, use_per_byte, users


@dataclass(frozen=True, slots=True)
class Limit(Constraint):
    """A constraint in force, and the measure of what messages use; adaptive below a `least` part of 1."""

    measure: Measure
    least: float = 1.0

    @property
    def shared(self) -> bool:
        """Whether all robots use it together; if not, each has all of it for itself."""
        return not self.measure.private


Send = tuple[float, tuple[float, ...]]
"""When something was sent [s], and what it used of each constraint."""


@dataclass(frozen=True, slots=True)
class Limits:
    """The constraints of a problem, and what was sent that counts against them, oldest first, by us and by others.

    Each counts over so many `windows`, more than one where messages are larger than it. `alone`: they are our part, for
    our streams only; larger messages take `turns`. `agreed`: all plans say the same of what others may have sent.
    """

    union: tuple[Limit, ...]
    sent: tuple[Send, ...] = ()
    others: tuple[Send, ...] = ()
    windows: tuple[float, ...] = ()
    alone: bool = False
    turns: bool = False
    agreed: bool = False


def limits_of(specs: Specs, allowance: float, robots: int) -> tuple[Limit, ...]:
    """Return the constraints in force, less the digests of so many robots; those that all share come first for all."""
    ordered = sorted(specs.constraints, key=lambda spec: spec.measure.private)
    return tuple(_limit(spec, allowance, robots) for spec in ordered)


def fingerprint(specs: Specs) -> int:
    """Return a number, not 0, that tells what these specs set all robots together from other limits."""
    shared = sorted(repr(spec.measure) + spec.name for spec in specs.constraints if not spec.measure.private)
    return zlib.crc32("\n".join(shared).encode()) or 1


def in_force(limits: tuple[Limit, ...], factors: Sequence[float]) -> tuple[Limit, ...]:
    """Return the limits with each adaptive one, in their order, at this part of its ceiling."""
    left = iter(factors)
    return tuple(replace(limit, limit=next(left) * limit.limit) if limit.least < 1.0 else limit for limit in limits)


def allowance_of(specs: Specs, allowance: float, robots: int) -> float:
    """Return what the digests of so many robots may use together [B/s], all copies counted."""
    rates = [robots * _digest_rate(spec.measure, allowance, robots) for spec in specs.constraints]
    return max(min(rates, default=0.0), robots * LEAST_RATE)


def use_of(size: int, copies: int, limits: tuple[Limit, ...], *, own: bool = True) -> tuple[float, ...]:
    """Return what a message uses of each constraint; `own`: whether this robot sends it."""
    return tuple([limit.measure.use(size, copies, own=own) for limit in limits])


def changes_plans(use: Sequence[float], limits: Iterable[Limit]) -> bool:
    """Whether so much of the limits is used that all others have to hear of it at once."""
    return exceeds(TUNING.large, use, limits)


def exceeds(part: float, use: Sequence[float], limits: Iterable[Limit]) -> bool:
    """Whether more than this part is used of a limit that robots share."""
    for amount, limit in zip(use, limits, strict=True):  # noqa: SIM110 - a generator would take twice as long
        if amount > part * limit.limit and limit.shared:
            return True
    return False


def is_bulky(use: Sequence[float], limits: Iterable[Constraint]) -> bool:
    """Whether a message is so large a part of what a limit lets pass that windows may be stretched for it."""
    for amount, limit in zip(use, limits, strict=True):  # noqa: SIM110 - a generator would take twice as long
        if amount > TUNING.bulky * limit.limit:
            return True
    return False


def stretched(limits: Sequence[Limit], windows: Sequence[float]) -> tuple[Limit, ...]:
    """Return the limits with so many windows' length and room each; as they are where nothing is said of windows."""
    if not windows:
        return tuple(limits)
    each = zip(limits, windows, strict=True)
    return tuple([replace(c, window=n * c.window, limit=n * c.limit) if n > 1.0 else c for c, n in each])


def longest_window(limits: Iterable[Constraint]) -> float:
    """Return the longest window [s]; 0.0 where there is no limit."""
    return max([limit.window for limit in limits], default=0.0)


def shortest_window(limits: Iterable[Limit]) -> float:
    """Return the shortest window of what robots share [s]; infinite where they share nothing."""
    return min([limit.window for limit in limits if limit.shared], default=math.inf)


def _limit(spec: ConstraintSpec, allowance: float, robots: int) -> Limit:
    measure = spec.measure
    digests = max(allowance * measure.limit, least_use(measure, robots))
    return Limit(spec.name, measure.window, left_by(digests, measure), measure, spec.least)


def _digest_rate(measure: Measure, allowance: float, robots: int) -> float:
    """What the digests of one robot may use by one measure [B/s], all copies together."""
    part = allowance * measure.limit / measure.window / users(measure, robots)
    return part / use_per_byte(measure, robots)
