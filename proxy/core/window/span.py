"""How many messages a window may hold, so that its decision comes in time: the core learns it from what others took.

Before its search can begin a window is built, handed over and tabulated, and afterwards its plan is explained. That
takes the longer the more messages it holds and the busier the machine is. A search can stop at any moment, and takes
the rest.
"""

import math

OVERHEAD = 0.5
"""All but the search should take no more than this part of the deadline."""
EACH = 50e-6
"""What a message of a mixed window takes on one x86 core [s]: taken for true until the first decisions were made."""
LEAST = 12
"""So many messages a window may always hold besides the current one: then they take less than 1 ms."""
OVERRUNS = 3
"""So many decisions in a row must take too long before messages are left out: a busy machine delays single ones..."""
SHRINKING = 0.5
"""... and then this part of the messages stays at least, for there may be other reasons..."""
GROWING = 1.1
"""... and one in time allows so many times as many."""


class Span:
    """The messages that a window may hold besides the current one, for decisions within a `deadline` [s]: `most`."""

    def __init__(self, deadline: float) -> None:
        self._deadline = deadline
        self.most = max(LEAST, OVERHEAD * deadline / EACH)
        self._overruns: list[float] = []
        """By how much the last decisions in a row took too long: what of their time was allowed."""

    def note(self, held: int, overhead: float, *, thinned: bool) -> None:
        """A decision took so long besides its search [s], on a window that held so many messages."""
        fitting = OVERHEAD * self._deadline / max(overhead, 1e-9)
        if fitting >= 1.0:
            self._overruns.clear()
            self.most *= min(fitting, GROWING) if thinned else 1.0
            return
        self._overruns = [*self._overruns, fitting][-OVERRUNS:]
        if len(self._overruns) == OVERRUNS:
            part = max(*self._overruns, SHRINKING)
            self.most = max(LEAST, math.floor(min(held, self.most) * part))
