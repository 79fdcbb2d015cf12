"""Equal parts, which nobody agrees on: overbooked, and what is larger goes by turns of the clock."""

from collections.abc import Callable, Sequence

from proxy.core.coordination.clock_turns import ClockTurns, Turn
from proxy.core.coordination.overbooking import Overbooking
from proxy.core.coordination.team import Team
from proxy.core.model.limits import Limit
from proxy.core.view.view import SharedView


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
