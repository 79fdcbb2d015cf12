"""What a robot gives back of what it was lent, until who lends has heard of it."""

from itertools import islice

from proxy.core.wire import BEGINS, Returned

TOLD = 2
"""What is given back is told so often: digests may be lost."""
MOST_RETURNED = 32
"""Of so much one digest tells that it is given back."""
LONGEST = 10.0
"""What is given back is remembered for so long after it would have ended: grants may be on their way [s]."""

Borrowed = tuple[float, tuple[int, ...]]
"""What a robot was lent: the begin on the clock of who lent it, and the parts of each limit."""


class GivenBack:
    """What is still to be told, and what is not held again although grants of it may still come."""

    def __init__(self) -> None:
        self._untold: dict[int, tuple[Returned, int]] = {}
        """By the last digits of its begin, and how often it is still to be told."""
        self._until: dict[Borrowed, float] = {}
        """Until when we were lent it [s]."""

    def __contains__(self, borrowed: Borrowed) -> bool:
        """Whether this was given back, lately."""
        return borrowed in self._until

    def add(self, borrowed: Borrowed, ends: float, used: float | None) -> None:
        """Give back what was lent until it `ends`; None: nothing was used [s]."""
        begins, self._until[borrowed] = last_digits(borrowed[0]), ends
        self._untold[begins] = Returned(begins, used or 0.0), TOLD

    def forget(self, now: float) -> None:
        """Forget what no grant can still be on its way of."""
        self._until = {borrowed: ends for borrowed, ends in self._until.items() if ends + LONGEST > now}

    def untold(self) -> tuple[Returned, ...]:
        """What one digest tells of what was not told often enough."""
        return tuple(islice((returned for returned, _ in self._untold.values()), MOST_RETURNED))

    def told(self) -> None:
        """That was told, once."""
        told = dict(islice(self._untold.items(), MOST_RETURNED))
        self._untold = {begins: each for begins, each in self._untold.items() if begins not in told}
        self._untold |= {begins: (each, times - 1) for begins, (each, times) in told.items() if times > 1}


def last_digits(begins: float) -> int:
    """By what a robot names what it was lent: the last digits of when it begins, in milliseconds."""
    return round(begins * 1e3) % BEGINS
