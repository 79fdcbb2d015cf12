"""What the constraints of the specs leave for messages, and what a message uses of them."""

from dataclasses import dataclass

from planner import Constraint
from utility_specs import Specs

LEAST_ALLOWANCE = 100.0
"""What the digests of one robot may use whatever the limit is [B/s]."""
LEAST_LEFT = 0.1
"""Part of a limit that digests leave to messages in any case."""


@dataclass(frozen=True, slots=True)
class Limits:
    """The constraints of a problem: those of the union of all robots, and what we hold of them ourselves.

    `held` is empty where the union alone binds us. `sent` are our own sends as (time, use), oldest first.
    """

    union: tuple[Constraint, ...]
    held: tuple[Constraint, ...]
    sent: tuple[tuple[float, tuple[float, ...]], ...]


def limits_of(specs: Specs, allowance: float, robots: int) -> tuple[Constraint, ...]:
    """Return the constraints in force for messages: what the specs allow, less the digests of so many robots."""
    limits = []
    for spec in specs.constraints:
        digests = max(allowance * spec.rate, LEAST_ALLOWANCE * robots)
        limits.append(
            Constraint(spec.name, spec.window, max(spec.rate - digests, LEAST_LEFT * spec.rate) * spec.window)
        )
    return tuple(limits)


def allowance_of(specs: Specs, allowance: float, robots: int) -> float:
    """Return what the digests of one of so many robots may use [B/s], all copies together."""
    rate = min((spec.rate for spec in specs.constraints), default=0.0)
    return max(allowance * rate / robots, LEAST_ALLOWANCE)


def use_of(size: int, copies: int, limits: tuple[Constraint, ...]) -> tuple[float, ...]:
    """Return what a message uses of each constraint: bytes on the air, in every copy."""
    return (float(size * copies),) * len(limits)
