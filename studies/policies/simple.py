"""Policies that do not plan."""

import random
from collections.abc import Callable
from typing import Protocol, runtime_checkable

from planner import Problem
from planner.constraints import violations
from planner.evaluation import tabulate_gains
from studies.policies.ranked import fits_by_rank, share


def send_all(_window: Problem) -> bool:
    """Send everything: ignores the constraints, for comparison only."""
    return True


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
    rivals = (i for i in opened if window.messages[i].t_sent <= until and worth[i] > 0)
    return fits_by_rank(window, {i: worth[i] / share(window, i) for i in rivals})


@runtime_checkable
class Draws(Protocol):
    """A policy that draws random numbers: where many decide, each is dealt its own."""

    def dealt(self, hand: str) -> Callable[[Problem], bool]:
        """Return the policy with the numbers of this hand."""


class RandomSends:
    """Send what fits with a probability; the same seed draws the same numbers, one a message.

    Without `limited` it sends whether it fits or not: the random dropping of the paper (§4.2).
    """

    def __init__(self, probability: float, seed: int | str = 0, *, limited: bool = True) -> None:
        self._probability = probability
        self._seed = seed
        self._limited = limited
        self._draw = random.Random(seed)

    def __call__(self, window: Problem) -> bool:
        """Draw, and send when the number says so and, if limited, no constraint forbids it."""
        return self._draw.random() < self._probability and (not self._limited or whenever_it_fits(window))

    def dealt(self, hand: str) -> "RandomSends":
        """Return the policy with the numbers of this hand."""
        return RandomSends(self._probability, f"{self._seed} {hand}", limited=self._limited)
