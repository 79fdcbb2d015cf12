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
SHRINKING = 0.5
"""A decision that took too long leaves at least this part of the messages, for there may be other reasons..."""
GROWING = 1.1
"""... and one in time allows so many times as many."""


class Span:
    """The messages that a window may hold besides the current one, for decisions within a `deadline` [s]: `most`."""

    def __init__(self, deadline: float) -> None:
        self._deadline = deadline
        self.most = max(LEAST, OVERHEAD * deadline / EACH)

    def note(self, held: int, overhead: float, *, thinned: bool) -> None:
        """A decision took so long besides its search [s], on a window that held so many messages."""
        fitting = OVERHEAD * self._deadline / max(overhead, 1e-9)
        if fitting < 1.0:
            self.most = max(LEAST, math.floor(min(held, self.most) * max(fitting, SHRINKING)))
        elif thinned:
            self.most *= min(fitting, GROWING)
