"""`sum`: every message counts, whatever else was received. There is nothing to remember: one state."""

from __future__ import annotations

import numpy as np

from planner.aggregations.part import Part
from planner.received import Received
from planner.utility import Floats


def tabulate(received: Received, worth: Floats | None) -> Part:
    """A message adds its own utility; `worth` is what each of the problem is worth beyond the window."""
    places = np.arange(len(received.stream))
    each = received.worth(places, received.t_rcv, np.full(len(places), np.inf))
    aim = each if worth is None else each + worth[received.index]
    opened, fact = received.opened, received.fact
    return Part(
        level=received.level,
        states=np.ones(len(opened), dtype=np.int64),
        after=np.zeros(len(opened), dtype=np.int64),
        gain=each[opened],
        aim=aim[opened],
        facts=float(each[fact].sum()),
        aim_facts=float(aim[fact].sum()),
        everything=float(each.sum()),
    )
