"""The messages of a window in the order of receipt, and what each is worth between two receipts."""

from collections.abc import Sequence
from functools import lru_cache
from typing import cast

import numpy as np

from planner.errors import ProblemError
from planner.problem import Problem
from planner.utility import Batched, Flags, Floats, Ints, MessageUtility


class Received:
    """The messages `indices` of a problem, stream by stream in the order of receipt; ties as in the window.

    A *place* is a position in this order. `level[i]` is that of the tree which decides the i-th open message here,
    and `opened[i]` its place.
    """

    def __init__(self, problem: Problem, indices: Ints, levels: Ints) -> None:
        columns = problem.columns
        order = np.lexsort((columns.t_rcv[indices], columns.stream[indices]))
        self.problem = problem
        self.index = indices[order]
        """The message of the problem at each place."""
        self.utilities, self.utility = columns.utilities, columns.utility[self.index]
        """Those that there are, and which of them the message at each place has."""
        self.stream = columns.stream[self.index]
        self.fact = columns.sent[self.index]
        self.t_gen = columns.t_gen[self.index]
        self.t_rcv = columns.t_rcv[self.index]
        self.scale = columns.scale[self.index]
        self.t_end = problem.t_end
        place = np.empty_like(order)
        place[order] = np.arange(len(order))
        self.opened = place[~columns.sent[indices]]
        self.level = levels
        self.delay, self.share = columns.delay, columns.share
        """Of each receiver of each stream of the problem, filled up with receivers of no share."""

    def facts_around(self) -> tuple[Ints, Ints]:
        """Return the places of the last fact before and the first after each; −1 and the count if none."""
        count = len(self.stream)
        places = np.arange(count)
        before = np.append(-1, np.maximum.accumulate(np.where(self.fact, places, -1))[:-1])
        after = np.append(np.minimum.accumulate(np.where(self.fact, places, count)[::-1])[::-1][1:], count)
        same_before = (before >= 0) & (self.stream[before] == self.stream)
        same_after = (after < count) & (self.stream[np.minimum(after, count - 1)] == self.stream)
        return np.where(same_before, before, -1), np.where(same_after, after, count)

    def next_received(self) -> Ints:
        """Return the place after each in its stream; the count after the last."""
        count = len(self.stream)
        last = np.append(self.stream[1:] != self.stream[:-1], np.ones(1, dtype=np.bool_))
        return np.where(last, count, np.arange(1, count + 1))

    def until(self, places: Ints) -> Floats:
        """Return when the messages at these places are received; never for the place after the last one [s]."""
        return np.append(self.t_rcv, np.inf)[places]

    def rising(self, which: Ints, begin: Floats, until: Floats) -> tuple[Floats, ...]:
        """Return what they are worth in parts, each of which only rises with `until` [utility·s]."""
        return (self.worth(which, begin, until),)

    def worth(self, which: Ints, begin: Floats, until: Floats) -> Floats:
        """Return what the messages at places `which` are worth to all receivers from `begin` to `until` [utility·s].

        Both times are on the clock of `t_rcv`; a receiver with a delay sees them later, but nothing after t_end.
        """
        born, streams, utility = self.t_gen[which], self.stream[which], self.utility[which]
        total = np.zeros(len(which))
        for delay, share in zip(self.delay.T, self.share.T, strict=True):
            late = delay[streams]
            start = np.maximum(begin + late - born, 0.0)
            end = np.maximum(np.minimum(until + late, self.t_end) - born, start)
            total += share[streams] * integrals(self.utilities, utility, start, end)
        return self.scale[which] * total


def integrals(utilities: Sequence[MessageUtility], which: Ints, start: Floats, end: Floats) -> Floats:
    """∫ of `utilities[which[j]]` over the ages `[start[j], end[j]]`, kind by kind [1]."""
    kinds = set(map(type, utilities))
    if len(kinds) == 1 and (batched := _batched(*kinds)) is not None:
        return batched.integrals(cast("Sequence[Batched]", utilities), which, start, end)
    result = np.zeros(len(which))
    for kind in sorted(kinds, key=lambda kind: f"{kind.__module__}.{kind.__qualname__}"):
        members: Flags = np.array([type(utility) is kind for utility in utilities])
        chosen = members[which]
        if chosen.any():  # other streams of the problem may have kinds that these do not have
            result[chosen] = _of_one_kind(kind, utilities, which[chosen], start[chosen], end[chosen])
    return result


@lru_cache
def _batched(kind: type[MessageUtility]) -> type[Batched] | None:
    """Return the kind as one that integrates many messages at once; None when it does not. To look takes long."""
    return cast("type[Batched]", kind) if issubclass(kind, Batched) else None


def _of_one_kind(
    kind: type[MessageUtility], utilities: Sequence[MessageUtility], which: Ints, start: Floats, end: Floats
) -> Floats:
    if (batched := _batched(kind)) is not None:
        used = [place for place, utility in enumerate(utilities) if type(utility) is kind]
        members = cast("list[Batched]", [utilities[place] for place in used])
        return batched.integrals(members, np.searchsorted(used, which), start, end)
    result = np.zeros(len(which))
    for at in np.unique(which):
        chosen = which == at
        try:
            result[chosen] = utilities[at].integral(start[chosen], end[chosen])
        except Exception as error:
            raise ProblemError(f"utility {kind.__name__}.integral() failed: {type(error).__name__}: {error}") from error
    return result
