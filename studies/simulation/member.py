"""One robot of a team from start to end: its core, its clock, and what its apps published."""

import math
from dataclasses import dataclass, field

from proxy.clock import Wall
from proxy.core.core import Core
from proxy.core.protocol.messages import State
from proxy.tuning import TUNING
from studies.simulation.clocks import Clock
from studies.simulation.records import Frame


@dataclass(slots=True, eq=False)
class Member:
    """`frames` wait for their decision, by number; `state` is what queries are answered with.

    `matching` says of each key of its whether anybody subscribes to it, as Zenoh told it last.
    """

    robot: str
    zid: str
    keys: tuple[str, ...]
    clock: Clock
    core: Core
    frames: dict[int, Frame] = field(default_factory=dict)
    state: State | None = None
    matching: dict[str, bool] = field(default_factory=dict)
    wake: float = -math.inf
    look: float = -math.inf
    running: bool = True

    def wall_step(self, t: float) -> Wall | None:
        """What is known of the wall clock, if that is news; looked at as often as daemons do."""
        if t < self.look:
            return None
        self.look = t + TUNING.wall_clock_interval
        shown, view = Wall(self.clock.wall_time(t) - self.now(t), self.clock.error), self.core.view
        stepped = abs(shown.offset - view.clocks.offset) >= TUNING.wall_clock_step
        return shown if stepped or shown.error != view.clocks.error else None

    def now(self, t: float) -> float:
        """What its monotonic clock shows at true time `t` [s]."""
        return self.clock.monotonic(t)
