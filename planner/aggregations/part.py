"""The table of some streams: states, and what sending each open message adds in each of them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from planner.utility import Floats, Ints


@dataclass(frozen=True, slots=True)
class Part:
    """What sending adds, by level and state of its stream; an *entry* is one of these pairs, in this order.

    Every stream begins in state 0, and stays in its state when a message is dropped. `states[i]` counts the states
    that its stream may be in at `level[i]`, `after` is the state that sending leads to. `gain` adds to U, `aim` to
    what the search maximises, but for the charges of beyond.py [utility·s].
    """

    level: Ints
    states: Ints
    after: Ints
    gain: Floats
    aim: Floats
    facts: float
    """U of the messages that are known to be sent [utility·s]."""
    aim_facts: float
    """The same, of what the search maximises [utility·s]."""
    everything: float
    """U(M) of Eq. 2: all messages of these streams received; of `current` without what is lost [utility·s]."""
    exact: bool = True
    """Whether no state stands for another one that there was no room for."""


def entries(states: Ints) -> tuple[Ints, Ints]:
    """Return for each entry the number of its level among those given, and its state."""
    of = np.repeat(np.arange(len(states)), states)
    return of, np.arange(len(of)) - (np.cumsum(states) - states)[of]


def join(parts: Sequence[Part]) -> Part:
    """Put the tables of different streams together, in the order of the levels."""
    if len(parts) == 1:
        return parts[0]
    level = np.concatenate([part.level for part in parts])
    states = np.concatenate([part.states for part in parts])
    begin = np.cumsum(states) - states
    order = np.argsort(level)
    of, state = entries(states[order])
    entry = begin[order][of] + state
    return Part(
        level=level[order],
        states=states[order],
        after=np.concatenate([part.after for part in parts])[entry],
        gain=np.concatenate([part.gain for part in parts])[entry],
        aim=np.concatenate([part.aim for part in parts])[entry],
        facts=sum(part.facts for part in parts),
        aim_facts=sum(part.aim_facts for part in parts),
        everything=sum(part.everything for part in parts),
        exact=all(part.exact for part in parts),
    )
