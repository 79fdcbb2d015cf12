"""Tables of single streams, put together by level."""

import numpy as np

from planner.aggregations.part import Part, entries, join


def part(levels, states, *, first):
    """A table whose gains count up from `first`."""
    count = sum(states)
    gain = np.arange(first, first + count, dtype=np.float64)
    return Part(np.array(levels), np.array(states), np.zeros(count, dtype=np.int64), gain, -gain, 1.0, 2.0, 3.0)


def test_entries_name_level_and_state():
    """Each level has one entry for each of its states, in order."""
    of, state = entries(np.array([1, 3, 2]))
    assert of.tolist() == [0, 1, 1, 1, 2, 2]
    assert state.tolist() == [0, 0, 1, 2, 0, 1]


def test_tables_join_in_the_order_of_levels():
    """The entries of a level stay together, whichever table they come from; sums add up."""
    joined = join([part([1, 3], [2, 3], first=10), part([0, 2], [1, 2], first=20)])
    assert joined.level.tolist() == [0, 1, 2, 3]
    assert joined.states.tolist() == [1, 2, 2, 3]
    assert joined.gain.tolist() == [20, 10, 11, 21, 22, 12, 13, 14]
    assert joined.aim.tolist() == [-g for g in joined.gain]
    assert (joined.facts, joined.aim_facts, joined.everything) == (2.0, 4.0, 6.0)
