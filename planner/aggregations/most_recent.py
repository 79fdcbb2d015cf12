"""`most_recent`: the message received last counts (Markovian, §3.2.2).

The utility of a stream is a sum over consecutive received messages, so adding message m' changes it by an amount
that depends only on the last message before m' and the first after it. The messages known to be sent are fixed, and
the open ones are decided in the order of receipt. So a stream's state is which of its open messages was the last
one sent: 0 for none, else 1 + its number among them.
"""

from __future__ import annotations

import numpy as np

from planner.aggregations.part import Part, entries
from planner.errors import ProblemError
from planner.received import Received
from planner.utility import Floats

MAX_GAINS = 4_000_000
"""The greatest number of tabulated gains (32 MB); beyond it the horizon is a mistake."""


def tabulate(received: Received, worth: Floats | None) -> Part:
    """A message adds its own utility and takes that of the one before, from its receipt on.

    `worth` is what each message of the problem is worth beyond the window as the last of its stream.
    """
    count, opened = len(received.stream), received.opened
    places = np.arange(count)
    fact_before, fact_after = received.facts_around()
    in_order = np.sort(opened)
    first = np.searchsorted(received.stream[in_order], received.stream[opened])
    number = np.searchsorted(in_order, opened) - first
    entry_count = int((number + 1).sum())
    if entry_count > MAX_GAINS:
        raise ProblemError(f"the window has {entry_count:,} gains to tabulate, at most {MAX_GAINS:,} are possible")
    of, state = entries(number + 1)
    sent_before = np.where(state > 0, in_order[first[of] + np.maximum(state, 1) - 1], -1)
    before = np.maximum(sent_before, fact_before[opened[of]])
    facts = np.flatnonzero(received.fact)

    which = np.concatenate((opened, np.maximum(before, 0), places, facts))
    begin = received.t_rcv[np.concatenate((opened, opened[of], places, facts))]
    until = np.concatenate((fact_after[opened], fact_after[opened[of]], received.next_received(), fact_after[facts]))
    each = received.worth(which, begin, received.until(until))
    own, lost, everything, known = np.split(each, np.cumsum((len(opened), len(of), count)))
    gain = own[of] - np.where(before >= 0, lost, 0.0)
    total = float(known.sum())
    aim, aim_facts = gain, total
    if worth is not None:
        left = np.append(worth, 0.0)
        replaced = np.where(before >= 0, received.index[before], -1)
        lasts = fact_after[opened[of]] == count
        aim = gain + np.where(lasts, left[received.index[opened[of]]] - left[replaced], 0.0)
        aim_facts += float(worth[received.index[facts[fact_after[facts] == count]]].sum())
    return Part(received.level, number + 1, number[of] + 1, gain, aim, total, aim_facts, float(everything.sum()))
