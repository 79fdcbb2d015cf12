"""The messages of a window as paths in a network: a plan is one path for each stream.

A stream of n messages, in the order of receipt, has a node for each message and n + 1 *empty* nodes. To be
at the node of message m means that m was received last; to be at the empty node k means that nothing
received so far is worth anything any more and the messages before k are decided. A path starts at the empty
node 0 and ends at the empty node n:

    m → m'              gains ∫ U_m between the receipts of m and m'
    m → empty(k)        gains all that m has left; k is the first message received when m is worthless
    empty(k) → m_k      gains nothing: m_k is sent
    empty(k) → empty(k + 1)   gains nothing: m_k is not sent

The empty nodes keep the network small and exact: a message needs no arcs to those received after its life.
Messages known to be sent lie on every path: no arc leads past them.
"""

from dataclasses import dataclass

import numpy as np

from planner import Problem
from planner.received import integrals
from planner.utility import Floats, Ints


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


def build_network(problem: Problem) -> Network:
    """Build the network of a valid problem."""
    return _Received(problem).network()


class _Received:
    """The messages of a window in the order of receipt, stream by stream; ties as in the window."""

    def __init__(self, problem: Problem) -> None:
        messages = problem.messages
        self.order: Ints = np.lexsort(([m.t_rcv for m in messages], [m.stream for m in messages]))
        ordered = [messages[index] for index in self.order]
        self.utilities = [m.utility for m in ordered]
        self.stream = np.array([m.stream for m in ordered], dtype=np.int64)
        self.fact = np.array([m.sent for m in ordered], dtype=np.bool_)
        self.t_gen = np.array([m.t_gen for m in ordered], dtype=np.float64)
        self.t_rcv = np.minimum(np.array([m.t_rcv for m in ordered], dtype=np.float64), problem.t_end)
        self.scale = np.array([m.scale for m in ordered], dtype=np.float64)
        self.t_end = problem.t_end
        self.place = np.arange(len(ordered))
        self.last: Ints = np.searchsorted(self.stream, self.stream, side="right")
        """One past the last place of the stream of each place."""

    def network(self) -> Network:
        """Join the arcs of all kinds."""
        streams, first = np.unique(self.stream, return_inverse=True)
        rank = np.asarray(first, dtype=np.int64)
        death, next_fact = self._death(), self._next_fact()
        # An empty node for each place and one for the end of each stream: `rank` counts the ends before.
        empty = len(self.place) + self.place + rank
        end = len(self.place) + self.last + rank
        tail, head = self._direct(death, next_fact)
        fading = np.flatnonzero(death <= next_fact)
        faded = np.where(death < self.last, empty[np.minimum(death, len(empty) - 1)], end)
        skipped = np.flatnonzero(~self.fact)
        left_out = np.zeros(len(self.place) + len(skipped))
        return Network(
            message=self.order,
            tail=np.concatenate((tail, fading, empty, empty[skipped])),
            head=np.concatenate((head, faded[fading], self.place, empty[skipped] + 1)),
            gain=np.concatenate((self._worth(tail, self.t_rcv[head]), self._whole(fading), left_out)),
            source=np.unique(empty[np.searchsorted(self.stream, streams)]),
            sink=np.unique(end),
            nodes=2 * len(self.place) + len(streams),
        )

    def _direct(self, death: Ints, next_fact: Ints) -> tuple[Ints, Ints]:
        """Return tails and heads of the arcs to messages received in the tail's life, up to the next fact."""
        count = np.minimum(death, np.minimum(next_fact + 1, self.last)) - self.place - 1
        tail = np.repeat(self.place, count)
        within = np.arange(len(tail)) - np.repeat(np.cumsum(count) - count, count)
        return tail, tail + 1 + within

    def _death(self) -> Ints:
        """Return for each message the first place of its stream where it has nothing left, else the end."""
        whole = self._whole(self.place)
        low, high = self.place + 1, self.last.copy()
        received = np.append(self.t_rcv, self.t_end)
        while (open_ := np.flatnonzero(low < high)).size:
            middle = (low[open_] + high[open_]) // 2
            over = self._worth(open_, received[middle]) >= whole[open_]
            high[open_[over]] = middle[over]
            low[open_[~over]] = middle[~over] + 1
        return low

    def _next_fact(self) -> Ints:
        """Return the first fact after each place, the end of its stream if none."""
        count = len(self.place)
        ahead = np.minimum.accumulate(np.where(self.fact, self.place, count)[::-1])[::-1]
        return np.asarray(np.minimum(np.append(ahead[1:], count), self.last))

    def _whole(self, which: Ints) -> Floats:
        return self._worth(which, np.full(len(which), self.t_end))

    def _worth(self, which: Ints, until: Floats) -> Floats:
        """Return the scaled ∫ of the utility of messages from their receipt to `until` [utility·s]."""
        start = np.maximum(self.t_rcv[which] - self.t_gen[which], 0.0)
        end = np.maximum(until - self.t_gen[which], start)
        return np.asarray(self.scale[which] * integrals(self.utilities, which, start, end))
