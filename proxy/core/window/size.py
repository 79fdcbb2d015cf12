"""How many messages a window may hold, so that its decision comes in time: by what others took besides their search."""

import math

from proxy.core.window.tuning import TUNING


class WindowSize:
    """The `messages` that a window may hold besides the current one, for decisions within a `deadline` [s]."""

    def __init__(self, deadline: float) -> None:
        self._deadline = deadline
        self.messages = max(TUNING.fewest_messages, TUNING.overhead * deadline / TUNING.seconds_per_message)
        self._overruns: list[float] = []
        """By how much the last decisions in a row took too long: what of their time was allowed."""

    def note(self, held: int, overhead: float, *, thinned: bool) -> None:
        """A decision took so long besides its search [s], on a window that held so many messages."""
        fitting = TUNING.overhead * self._deadline / max(overhead, 1e-9)
        if fitting >= 1.0:
            self._overruns.clear()
            self.messages *= min(fitting, TUNING.growing) if thinned else 1.0
            return
        self._overruns = [*self._overruns, fitting][-TUNING.overruns :]
        if len(self._overruns) == TUNING.overruns:
            part = max(*self._overruns, TUNING.shrinking)
            self.messages = max(TUNING.fewest_messages, math.floor(min(held, self.messages) * part))
