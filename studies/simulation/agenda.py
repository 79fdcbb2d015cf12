"""What is to happen when: the discrete events of a simulation."""

import heapq
from collections.abc import Callable

Action = Callable[[float], None]
"""Called with the true time at which it happens [s]."""


class Agenda:
    """Actions in the order of their times, those of one time in the order in which they were put down."""

    def __init__(self) -> None:
        self._actions: list[tuple[float, int, Action]] = []
        self._order = 0

    def at(self, t: float, action: Action) -> None:
        """Let `action` happen at `t` [s]."""
        self._order += 1
        heapq.heappush(self._actions, (t, self._order, action))

    def run(self, until: float) -> None:
        """Let everything happen that is due by `until` [s], and what comes of it by then."""
        while self._actions and self._actions[0][0] <= until:
            t, _, action = heapq.heappop(self._actions)
            action(t)
