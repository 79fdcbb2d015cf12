"""Policies to compare: how the current message of a window may be decided."""

from dataclasses import dataclass

import planner
from planner import Problem, SearchSettings
from planner.constraints import violations
from planner.evaluation import tabulate_gains


def whenever_it_fits(window: Problem) -> bool:
    """Send whenever no constraint forbids it."""
    return not violations(window, [window.current])


def by_rank(window: Problem) -> bool:
    """Send when the message finds room after all that are worth more and compete with it.

    Its competitors are the messages sent within the longest constraint window from now on. They are ranked by what
    each would add to what was sent already, per share of a limit, and take the room in this order.
    """
    opened = [index for index, message in enumerate(window.messages) if not message.sent]
    gains = tabulate_gains(window)
    worth = dict(zip(opened, gains.gain[gains.start[:-1]].tolist(), strict=True))
    until = window.messages[window.current].t_sent + max((c.window for c in window.constraints), default=0.0)
    rivals = [i for i in opened if window.messages[i].t_sent <= until and worth[i] > 0]
    placed: list[int] = []
    for index in sorted(rivals, key=lambda i: worth[i] / _share(window, i), reverse=True):
        if not violations(window, [*placed, index]):
            placed.append(index)
            if index == window.current:
                return True
    return False


def _share(window: Problem, index: int) -> float:
    """Return the greatest share of a limit that a message uses; a little for one that uses none."""
    limits = [constraint.limit for constraint in window.constraints]
    shares = [use / limit for use, limit in zip(window.messages[index].use, limits, strict=True) if limit > 0]
    return max(shares, default=0.0) or 1e-9


@dataclass(frozen=True, slots=True)
class Planned:
    """Send when the planner says so after `iterations`."""

    settings: SearchSettings
    iterations: int
    seed: int = 0

    def __call__(self, window: Problem) -> bool:
        """Search the window and return the decision."""
        search = planner.start(window, self.settings, self.seed)
        search.run(self.iterations)
        return search.plan().send
