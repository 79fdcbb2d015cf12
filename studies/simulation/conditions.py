"""Under which conditions a team flies a mission."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from proxy.core.model.settings import UNICAST
from studies.simulation.churn import Happening
from studies.simulation.clocks import Clock
from studies.simulation.medium import Way
from utility_specs.digests import LEAST_RATE

WARM_UP = 10.0
"""Flown but not scored [s]."""
WINDOW = 2.5
"""Of the limit [s]."""

Coordination = Literal["announce", "split"]
Transport = Literal["unicast", "broadcast"]


@dataclass(frozen=True, slots=True)
class Conditions:
    """How a mission is flown.

    `limit` counts messages per `window` [s]; ten robots generate 25 in `WINDOW`. With `digests_inside` it is what
    messages and digests may use together, else what is left to messages. `latency` and `jitter` are seconds, `loss`,
    `duplication` and
    `reordering` probabilities; `ways` are those of single pairs. `rate` is that of the medium [B/s]; as it is, no queue
    shows. `rates` are times [s] and rates. With `digests_on_air` a digest is broadcast where samples are. Wall
    clocks are wrong by `clock_error` at most, as their robots know [s]; 0.0: they do not know.
    """

    coordination: Coordination = "announce"
    transport: Transport = "unicast"
    limit: int = 5
    window: float = WINDOW
    latency: float = 0.02
    jitter: float = 0.0
    loss: float = 0.0
    duplication: float = 0.0
    reordering: float = 0.0
    seconds: float = 60.0
    robots: int = 10
    iterations: int = 300
    allowance: float = 0.02
    digests_inside: bool = False
    digests_on_air: bool = True
    rate: float = 1e6
    rates: tuple[tuple[float, float], ...] = ()
    clocks: Mapping[str, Clock] = field(default_factory=dict)
    clock_error: float = 0.0
    ways: Mapping[tuple[str, str], Way] = field(default_factory=dict)
    happenings: Sequence[Happening] = ()

    @property
    def unicast(self) -> bool:
        """Whether there is an operator who wants everything; else every robot does."""
        return self.transport == UNICAST

    @property
    def members(self) -> int:
        """Robots and, in unicast, the operator."""
        return self.robots + self.unicast

    def gross(self, carried: float) -> float:
        """Return what the specs allow per window so that `carried` is left to messages [B]."""
        if self.digests_inside:
            return carried
        return max(carried / (1.0 - self.allowance), carried + LEAST_RATE * self.members * self.window)
