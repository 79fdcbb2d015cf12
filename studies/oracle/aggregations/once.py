"""`once`: a plan is a path to the first message received.

A stream of n messages, in the order of receipt, has n + 1 nodes. To be at node k means that none of the messages
before k was received; the path ends at node n, with a message or without:

    k → n       gains all of message k, which is received first: the column of the message itself
    k → k + 1   gains nothing: message k is not sent; no such arc for messages that are known to be sent

What is sent after the first message is worth nothing. So no path tells of it, and open messages of which none tells
are not sent. Messages known to be sent, which may be first or not, have an arc of their own to the end.
"""

import numpy as np

from planner.received import Received
from studies.oracle.aggregations.part import Part, arcs


def build(received: Received) -> Part:
    """Build the paths of all streams."""
    count, places = len(received.problem.messages), np.arange(len(received.index))
    rank = np.unique(received.stream, return_inverse=True)[1]
    node = places + rank
    end = np.searchsorted(received.stream, received.stream, side="right") + rank
    whole = received.worth(places, received.t_rcv, np.full(len(places), np.inf))
    opened, facts = np.flatnonzero(~received.fact), np.flatnonzero(received.fact)
    own = count + np.arange(len(places))
    supply = np.zeros(len(places) + int(rank.max()) + 1)
    supply[np.unique(end)] = 1.0
    supply[node[np.searchsorted(received.stream, np.unique(received.stream))]] = -1.0
    gain = np.zeros(count)
    gain[received.index[opened]] = whole[opened]
    return Part(
        gain=np.concatenate((gain, np.zeros(len(opened)), whole[facts])),
        balance=arcs(
            np.concatenate((received.index[opened], own)),
            np.concatenate((node[opened], node[opened], node[facts])),
            np.concatenate((end[opened], node[opened] + 1, end[facts])),
        ),
        supply=supply,
        skips=np.zeros(count + len(places), dtype=np.int64),
    )
