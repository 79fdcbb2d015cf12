"""What is to happen when: the discrete events of a simulation."""

import heapq
from collections.abc import Callable

Action = Callable[[float], None]
"""Called with the true time at which it happens [s]."""


Outside = Callable[[float], bool]
"""Goes on to a time [s]; whether anything happened on the way, which it did in time: then it has stopped there."""


class Agenda:
    """Actions in the order of their times, those of one time in the order in which they were put down."""

    def __init__(self) -> None:
        self._actions: list[tuple[float, int, Action]] = []
        self._order = 0
        self._outside: Outside | None = None

    def at(self, t: float, action: Action) -> None:
        """Let `action` happen at `t` [s]."""
        self._order += 1
        heapq.heappush(self._actions, (t, self._order, action))

    def beside(self, outside: Outside) -> None:
        """Keep pace with another simulator: it comes before what is due at the same time."""
        self._outside = outside

    def run(self, until: float) -> None:
        """Let everything happen that is due by `until` [s], and what comes of it by then."""
        while True:
            due = min(self._actions[0][0], until) if self._actions else until
            if self._outside is not None and self._outside(due):
                continue
            if not self._actions or self._actions[0][0] > until:
                return
            t, _, action = heapq.heappop(self._actions)
            action(t)
