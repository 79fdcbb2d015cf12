"""Equal parts, which nobody agrees on: overbooked, and what is larger goes by turns of the clock."""

import math
from collections.abc import Callable, Sequence

from proxy.core.coordination.clock_turns import ClockTurns, Turn
from proxy.core.coordination.team import Team
from proxy.core.coordination.tuning import TUNING
from proxy.core.model.limits import Limit
from proxy.core.view.view import SharedView


class Overbooking:
    """What one robot uses of an equal part, and by what `factor` it may use more, as seldom all use theirs at once.

    The mean of what it uses, and some deviations of the mean of so many robots, are its part: fifty robots with streams
    of 0.1 to 4 kB reach 96 % of central so instead of 81, with at most 0.2 % of the windows over.
    """

    def __init__(self) -> None:
        self.factor = 1.0
        self._began = self._looked = -math.inf
        self._weight = self._mean = self._square = 0.0

    def advance(self, now: float, used: float, robots: int) -> None:
        """Of what we may use within the windows that end now this part is used, in a team of so many robots."""
        since = now - self._looked
        if since > TUNING.use_memory:
            self._began, self._weight, self._mean, self._square = now, 0.0, 0.0, 0.0
            since = 0.0
        self._looked = now
        fades = math.exp(-since / TUNING.use_memory)
        self._weight = fades * self._weight + 1.0 - fades
        self._mean = fades * self._mean + (1.0 - fades) * used
        self._square = fades * self._square + (1.0 - fades) * used * used
        if now < self._began + TUNING.use_known:
            self.factor = 1.0
            return
        mean, square = self._mean / self._weight, self._square / self._weight
        spread = math.sqrt(max(0.0, square - mean * mean) / robots)
        deviations = TUNING.use_deviations + TUNING.few_deviations / robots
        self.factor = 1.0 / min(1.0, max(mean + deviations * spread, 1.0 / TUNING.overbooked))


class EqualParts:
    """What each robot of a team has that is too large, or hears too little, to agree on parts."""

    def __init__(self, now: float) -> None:
        self.by_clock = False
        """Whether messages that are larger than an equal part go by turns that nobody agrees on."""
        self._overbooking = Overbooking()
        self._turns = ClockTurns(now, ())

    def set_windows(self, now: float, windows: Sequence[float]) -> None:
        """The shared limits have these windows now [s]."""
        self._turns = ClockTurns(now, windows)

    def look(
        self, now: float, view: SharedView, limits: tuple[Limit, ...], team: Team, using: Callable[[float], float]
    ) -> None:
        """See who has parts, how large messages are, and what part is used, by `using`, of what we may."""
        self.by_clock = team.large or team.gave_up
        if self.by_clock:
            self._turns.look(view, limits, team.members)
        self._overbooking.advance(now, using(now), team.sharing)

    def rest(self) -> None:
        """Nobody has an equal part."""
        self.by_clock = False

    def part(self, team: Team) -> float:
        """Return what part of each shared limit we may use within a window."""
        return self._overbooking.factor / team.sharing

    def turn(self, now: float, k: int, part: float) -> Turn:
        """Return our turn with a message that takes this part of limit `k`."""
        return self._turns.turn(now, k, part)

    def sent(self, now: float, uses: Sequence[float]) -> None:
        """A message was sent that uses such parts of the shared limits."""
        if self.by_clock:
            self._turns.sent(now, uses)
