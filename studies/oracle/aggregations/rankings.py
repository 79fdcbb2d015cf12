"""Rankings: in which order the messages of a stream are worth most, at different times.

They rank by age and by scale, and one that is not received yet has no rank at all. A *ranking* is all the time, of all
receivers, in which the same messages rank in the same order, so that the first one sent in this order is worth what it
is worth all that time together. It ends with the first message that is known to be sent, and with the last one that is
worth anything.

Time is cut at receipts and evenly in between, and cut finer where ranks change, `ROUNDS` times. So what is lost for a
change of ranks within a piece is about a millionth of what the messages are worth between two receipts.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from planner.received import Received, integrals
from planner.utility import Flags, Floats, Ints

PIECES = 8
"""Into so many pieces the time between two receipts is cut, and pieces in which ranks change are cut again."""

ROUNDS = 2


@dataclass(slots=True)
class Rankings:
    """The rankings of one stream, by the places of messages in the order of receipt."""

    areas: dict[tuple[int, ...], Floats] = field(default_factory=dict)
    """What each message of a ranking is worth while it holds [utility·s]."""
    newest_first: bool = True
    """Whether at any time messages rank by receipt, the newest first: then the stream is one of `most_recent`."""

    def add(self, ranked: Ints, areas: Floats) -> None:
        """Count a piece of time to its ranking."""
        if len(ranked):
            key = tuple(ranked.tolist())
            self.areas[key] = self.areas.get(key, np.zeros(len(ranked))) + areas


def rank(received: Received, stream: int) -> Rankings:
    """Find the rankings of one stream, receiver by receiver, from each receipt to the next."""
    found = Rankings()
    places = np.flatnonzero(received.stream == stream)
    delays, shares = received.delay, received.share
    for delay, share in zip(delays[stream].tolist(), shares[stream].tolist(), strict=True):
        receipts = received.t_rcv[places] + delay
        times = np.unique(np.append(receipts[receipts < received.t_end], received.t_end))
        for begin, end in zip(times[:-1].tolist(), times[1:].tolist(), strict=True):
            newest = places[receipts <= begin][::-1]
            for areas, order in _pieces(received, newest, begin, end):
                length = _length(received.fact[newest[order]], share * areas[order])
                found.add(newest[order[:length]], share * areas[order[:length]])
                found.newest_first &= bool((order[:length] == np.arange(length)).all())
    return found


def _length(facts: Flags, areas: Floats) -> int:
    """Return after how many messages of descending areas a ranking ends."""
    worth = int((areas > 0).sum())
    return min(worth, int(facts.argmax()) + 1) if facts.any() else worth


def _pieces(received: Received, present: Ints, begin: float, end: float) -> Iterator[tuple[Floats, Ints]]:
    """Yield areas and descending order of the messages `present`, piece by piece of the time."""
    edges = np.linspace(begin, end, PIECES + 1)
    for finer in range(ROUNDS + 1):
        areas = _areas(received, present, edges)
        order = np.argsort(-areas, axis=0, kind="stable")
        changes = (order[:, 1:] != order[:, :-1]).any(axis=0)
        if finer == ROUNDS:
            break
        # A change within the first or the last piece may show in no other one.
        near = np.append(changes, values=True) | np.append(True, changes)
        cuts = np.linspace(edges[:-1][near], edges[1:][near], PIECES + 1)
        edges = np.unique(np.concatenate((edges, cuts.ravel())))
    starts = np.flatnonzero(np.append(True, changes))
    total = np.add.reduceat(areas, starts, axis=1)
    yield from ((total[:, at], order[:, start]) for at, start in enumerate(starts.tolist()))


def _areas(received: Received, present: Ints, edges: Floats) -> Floats:
    """Return the scaled ∫ of the utility of each message over each piece."""
    which, piece = (axis.ravel() for axis in np.indices((len(present), len(edges) - 1)))
    born = received.t_gen[present[which]]
    start = np.maximum(edges[:-1][piece] - born, 0.0)
    area = integrals(
        received.utilities, received.utility[present[which]], start, np.maximum(edges[1:][piece] - born, start)
    )
    return (received.scale[present[which]] * area).reshape(len(present), -1)
