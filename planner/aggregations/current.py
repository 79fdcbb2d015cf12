"""`current`: the message received last counts, less what is lost while it shows more than there is (`excess.py`).

What is lost is a sum over times, too: so the table is that of `most_recent`, of messages that are worth less.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from planner.aggregations import most_recent
from planner.aggregations.part import Part
from planner.excess import Excess
from planner.problem import Problem
from planner.received import Received
from planner.utility import Floats, Ints


class Shown(Received):
    """Messages in the order of receipt, of streams of `current`: what each is worth may be less than nothing."""

    @classmethod
    def of(cls, received: Received) -> Shown:
        """Return the same messages as those of `current`."""
        return cls(received.problem, np.sort(received.index), received.level)

    def __init__(self, problem: Problem, indices: Ints, levels: Ints) -> None:
        super().__init__(problem, indices, levels)
        self._excess = Excess(problem)

    def worth(self, which: Ints, begin: Floats, until: Floats) -> Floats:
        """Return what the messages at places `which` are worth to all receivers, less what they lose [utility·s]."""
        return super().worth(which, begin, until) - self.lost(which, begin, until)

    def rising(self, which: Ints, begin: Floats, until: Floats) -> tuple[Floats, ...]:
        """Return what they are worth, and what they lose [utility·s]."""
        return super().worth(which, begin, until), self.lost(which, begin, until)

    def lost(self, which: Ints, begin: Floats, until: Floats) -> Floats:
        """Return what they lose to all receivers from `begin` to `until`, as they see it [utility·s]."""
        streams = self.stream[which]
        total = np.zeros(len(which))
        for delay, share in zip(self.delay.T, self.share.T, strict=True):
            late = delay[streams]
            end = np.minimum(until + late, self.t_end)
            total += share[streams] * self._excess.lost(self.index[which], begin + late, end)
        return total


def tabulate(received: Received, worth: Floats | None) -> Part:
    """Like `most_recent`. What all messages together lose is no part of `everything`, which scores are divided by."""
    shown = Shown.of(received)
    part = most_recent.tabulate(shown, worth)
    places = np.arange(len(shown.stream))
    lost = shown.lost(places, shown.t_rcv, shown.until(shown.next_received()))
    return replace(part, everything=part.everything + float(lost.sum()))
