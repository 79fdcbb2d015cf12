"""`once`: the message received first counts, no other. A stream has sent none of its open messages, or some."""

from __future__ import annotations

import numpy as np

from planner.aggregations.part import Part, entries
from planner.received import Received
from planner.utility import Floats


def tabulate(received: Received, worth: Floats | None) -> Part:
    """The first message adds its own utility, less that of a fact received later, which then is not the first.

    `worth` is what each message of the problem is worth beyond the window when it is the first.
    """
    count, opened = len(received.stream), received.opened
    places = np.arange(count)
    whole = received.worth(places, received.t_rcv, np.full(count, np.inf))
    beyond = np.zeros(count) if worth is None else worth[received.index]
    fact_before, fact_after = received.facts_around()
    head = np.append(True, received.stream[1:] != received.stream[:-1])
    leads = received.fact & (fact_before < 0)

    in_order = np.sort(opened)
    number = np.searchsorted(in_order, opened) - np.searchsorted(received.stream[in_order], received.stream[opened])
    states = np.minimum(number + 1, 2)
    of, state = entries(states)
    at = opened[of]
    counts = (state == 0) & (fact_before[at] < 0)
    gain = np.where(counts, whole[at] - np.append(whole, 0.0)[fact_after[at]], 0.0)
    left = np.where(counts, beyond[at] - np.append(beyond, 0.0)[fact_after[at]], 0.0)
    facts = float(whole[leads].sum())
    return Part(
        level=received.level,
        states=states,
        after=np.ones(len(of), dtype=np.int64),
        gain=gain,
        aim=gain + left,
        facts=facts,
        aim_facts=facts + float(beyond[leads].sum()),
        everything=float(whole[head].sum()),
    )
