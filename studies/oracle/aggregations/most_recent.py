"""`most_recent`: a plan is a path for each stream, through the messages that are sent.

A stream of n messages, in the order of receipt, has a node for each message and n + 1 *empty* nodes. To be
at the node of message m means that m was received last; to be at the empty node k means that nothing
received so far is worth anything any more and the messages before k are decided. A path starts at the empty
node 0 and ends at the empty node n:

    m → m'              gains ∫ U_m between the receipts of m and m', summed over receivers
    m → empty(k)        gains all that m has left; k is the first message received when m is worthless to everybody
    empty(k) → m_k      gains nothing: m_k is sent
    empty(k) → empty(k + 1)   gains nothing: m_k is not sent

The empty nodes keep the network small and exact: a message needs no arcs to those received after its life.
Messages known to be sent lie on every path: no arc leads past them.

`current` is the same, of messages that also lose: one that shows too much to the end has arcs to all that come.
"""

from dataclasses import dataclass

import numpy as np

from planner.received import Received
from planner.utility import Floats, Ints
from studies.oracle.aggregations.part import Part, arcs, joined


@dataclass(frozen=True, slots=True)
class Network:
    """Arcs between nodes: first those of the messages by receipt, stream by stream, then the empty ones.

    `message[place]` is the index in the problem of the message with that node. `source` and `sink` are the
    first and the last empty node of every stream that has messages.
    """

    message: Ints
    tail: Ints
    head: Ints
    gain: Floats
    source: Ints
    sink: Ints
    nodes: int


def build(received: Received) -> Part:
    """Build the paths of all streams.

    The node of a message is where its column begins; the column ends at a node of its own, one of those behind the
    others, where the arcs out of the message begin. So the column carries what passes the message.
    """
    network, messages = build_network(received), len(received.problem.messages)
    count, columns = len(network.message), messages + np.arange(len(network.gain))
    place = np.arange(count)
    direct = (network.tail < count) & (network.head < count)
    supply = np.zeros(network.nodes + count)
    supply[network.source] = -1.0
    supply[network.sink] = 1.0
    outflow = np.where(network.tail < count, network.tail + network.nodes, network.tail)
    return Part(
        gain=np.concatenate((np.zeros(messages), network.gain)),
        balance=joined([arcs(columns, outflow, network.head), arcs(network.message, place, place + network.nodes)]),
        supply=supply,
        skips=np.concatenate(
            (np.zeros(messages, dtype=np.int64), np.where(direct, network.head - network.tail - 1, 0))
        ),
    )


def build_network(received: Received) -> Network:
    """Join the arcs of all kinds."""
    place = np.arange(len(received.index))
    streams, rank = np.unique(received.stream, return_inverse=True)
    last = np.searchsorted(received.stream, received.stream, side="right")
    next_fact = np.minimum(received.facts_around()[1], last)
    death = _death(received, last)
    # An empty node for each place and one for the end of each stream: `rank` counts the ends before.
    empty = len(place) + place + rank
    end = len(place) + last + rank
    tail, head = _direct(np.minimum(death, np.minimum(next_fact + 1, last)) - place - 1)
    fading = np.flatnonzero(death <= next_fact)
    faded = np.where(death < last, empty[np.minimum(death, len(empty) - 1)], end)
    skipped = np.flatnonzero(~received.fact)
    left_out = np.zeros(len(place) + len(skipped))
    return Network(
        message=received.index,
        tail=np.concatenate((tail, fading, empty, empty[skipped])),
        head=np.concatenate((head, faded[fading], place, empty[skipped] + 1)),
        gain=np.concatenate((_worth(received, tail, head), _whole(received, fading), left_out)),
        source=np.unique(empty[np.searchsorted(received.stream, streams)]),
        sink=np.unique(end),
        nodes=2 * len(place) + len(streams),
    )


def _direct(count: Ints) -> tuple[Ints, Ints]:
    """Return tails and heads of the arcs from each place to the next ones, to so many."""
    tail = np.repeat(np.arange(len(count)), count)
    within = np.arange(len(tail)) - np.repeat(np.cumsum(count) - count, count)
    return tail, tail + 1 + within


def _death(received: Received, last: Ints) -> Ints:
    """Return for each message the first place of its stream where it has nothing left to gain or lose, or the end."""
    place = np.arange(len(last))
    whole = received.rising(place, received.t_rcv, np.full(len(place), np.inf))
    low, high = place + 1, last.copy()
    while (open_ := np.flatnonzero(low < high)).size:
        middle = (low[open_] + high[open_]) // 2
        parts = received.rising(open_, received.t_rcv[open_], received.t_rcv[middle])
        over = np.all([part >= complete[open_] for part, complete in zip(parts, whole, strict=True)], axis=0)
        high[open_[over]] = middle[over]
        low[open_[~over]] = middle[~over] + 1
    return low


def _whole(received: Received, which: Ints) -> Floats:
    return received.worth(which, received.t_rcv[which], np.full(len(which), np.inf))


def _worth(received: Received, which: Ints, until: Ints) -> Floats:
    """Return what messages are worth from their receipt to that of others [utility·s]."""
    return received.worth(which, received.t_rcv[which], received.t_rcv[until])
