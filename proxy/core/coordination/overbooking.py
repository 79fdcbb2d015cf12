"""What a robot may use beyond its part, as seldom all use theirs at once."""

import math
from collections.abc import Callable

from proxy.core.coordination.tuning import TUNING
from proxy.core.split.table import TableLog


class Overbooking:
    """What one robot uses of its part, and by what `factor` it may use more, as seldom all use theirs at once.

    The mean of what it uses, and some `deviations` of the mean of so many robots, are its part: fifty robots with
    streams of 0.1 to 4 kB reach 96 % of central so instead of 81, with at most 0.2 % of the windows over. Of unequal
    robots that agreed on parts one has room for two messages in a window and sends one, as another comes too late or is
    too large, and a third pauses: teams of twelve that used 33 and 44 % of a limit use 41 and 54 (central 80).
    """

    def __init__(self, deviations: float) -> None:
        self.factor = 1.0
        self._deviations = deviations
        self._began = self._looked = -math.inf
        self._weight = self._mean = self._square = 0.0

    def look(self, now: float, log: TableLog | None, using: Callable[[float], float], window: float) -> None:
        """See what we use, by `using`, of the parts of the tables that are in force, if any are.

        Messages that share slots use them in turn, and nobody uses more than its part beside them: of twelve robots
        with equal messages 4.2 % of the windows were over the limit, by up to 1.12.
        """
        if log is None or any(table.turns for table in log):
            self.factor = 1.0
        else:
            self.advance(now, using(now), log.agreed.allocation.alike, TUNING.agreed_memory * window)

    def advance(self, now: float, used: float, robots: float, memory: float = TUNING.use_memory) -> None:
        """Of what we may use within the windows that end now this part is used; it counts with this `memory` [s].

        In a team with parts that vary together as so many equal ones.
        """
        since = now - self._looked
        if since > memory:
            self._began, self._weight, self._mean, self._square = now, 0.0, 0.0, 0.0
            since = 0.0
        self._looked = now
        fades = math.exp(-since / memory)
        self._weight = fades * self._weight + 1.0 - fades
        self._mean = fades * self._mean + (1.0 - fades) * used
        self._square = fades * self._square + (1.0 - fades) * used * used
        if now < self._began + TUNING.use_known * memory:
            self.factor = 1.0
            return
        mean, square = self._mean / self._weight, self._square / self._weight
        spread = math.sqrt(max(0.0, square - mean * mean) / robots)
        deviations = self._deviations + TUNING.few_deviations / robots
        self.factor = 1.0 / min(1.0, max(mean + deviations * spread, 1.0 / TUNING.overbooked))
