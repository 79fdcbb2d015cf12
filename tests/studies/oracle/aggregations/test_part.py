"""Parts of a programme and how they are joined."""

import numpy as np

from studies.oracle.aggregations.part import Part, arcs, join


def path(message, gain):
    """A path of two nodes, beside three messages: over a message, or over an arc of its own."""
    alone = np.zeros(3)
    return Part(
        gain=np.append(alone, gain),
        balance=arcs(np.array([message, 3]), np.array([0, 0]), np.array([1, 1])),
        supply=np.array([-1.0, 1.0]),
        skips=np.array([0, 0, 0, 7]),
    )


def test_an_arc_leaves_one_node_and_enters_another():
    """Its column has −1 where it begins and 1 where it ends."""
    entries = arcs(np.array([5]), np.array([2]), np.array([3]))
    assert sorted(zip(entries.row, entries.column, entries.value, strict=True)) == [(2, 5, -1.0), (3, 5, 1.0)]


def test_parts_share_the_messages_and_nothing_else():
    """Columns of messages stay where they are, those of each part and its rows move behind the last part's."""
    whole = join(3, [path(0, 2.0), path(2, 5.0)])
    assert whole.gain.tolist() == [0.0, 0.0, 0.0, 2.0, 5.0]
    assert whole.supply.tolist() == [-1.0, 1.0, -1.0, 1.0]
    assert whole.skips.tolist() == [0, 0, 0, 7, 7]
    starts = whole.balance.value < 0
    assert set(zip(whole.balance.row[starts].tolist(), whole.balance.column[starts].tolist(), strict=True)) == {
        (0, 0),
        (0, 3),
        (2, 2),
        (2, 4),
    }


def test_no_parts():
    """A problem whose streams have no paths has columns for its messages only."""
    nothing = join(2, [])
    assert nothing.gain.tolist() == [0.0, 0.0]
    assert len(nothing.supply) == len(nothing.balance.row) == 0
