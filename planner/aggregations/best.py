"""`best`: at any time the received message with the greatest utility counts; the state is their upper envelope.

Time is cut into cells, at every receipt and in between. A message is worth its integral over each cell (closed form),
a set of messages what the best of them is worth there. Only where utilities cross within a cell is that less than the
integral of the envelope, by an amount that falls with the square of the cells.

Two sets of messages with the same envelope from the next receipt on are one state. There are never more than
`MAX_STATES` of a stream: beyond them a new envelope is taken for the nearest of those there are, and the table is no
longer `exact`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from planner.aggregations.part import Part, join
from planner.errors import ProblemError
from planner.received import Received, integrals
from planner.utility import Flags, Floats, Ints

CELLS = 128
"""Cells between the first receipt of a stream and the end of the window, besides those that receipts cut."""

CELLS_BEYOND = 32
"""Cells after the end of the window, as far as they count for what the search maximises."""

MAX_STATES = 256
"""States of a stream in one window."""

MAX_AREAS = 1_000_000
"""The greatest number of integrals of one stream over cells (8 MB); beyond it the horizon is a mistake."""


def tabulate(received: Received, until: Floats | None) -> Part:
    """Tabulate stream by stream; `until` is when the utility of each ends for what the search maximises [s]."""
    ends = np.full(len(received.problem.streams), received.t_end) if until is None else until
    return join(
        [_Stream(received, stream, float(ends[stream])).part() for stream in np.unique(received.stream).tolist()]
    )


@dataclass(frozen=True, slots=True)
class _Cells:
    """When the cells of one stream begin, on the clock of `t_rcv`, and what the message of each row is worth in them.

    `inside` tells the cells that count in U: those before t_end.
    """

    begin: Floats
    area: Floats
    inside: Flags


class _Stream:
    """The messages of one stream and the envelopes of what may be received of them."""

    def __init__(self, received: Received, stream: int, until: float) -> None:
        self._received = received
        self._places = np.flatnonzero(received.stream == stream)
        self._cells = _cut(received, self._places, until)

    def part(self) -> Part:
        """Follow the envelopes from receipt to receipt."""
        received, cells = self._received, self._cells
        fact = received.fact[self._places]
        here = np.isin(received.opened, self._places)
        level, rows = received.level[here], np.searchsorted(self._places, received.opened[here])
        envelopes = cells.area[fact].max(axis=0, initial=0.0)[None, :]
        facts = envelopes[0]
        after, gain, aim, exact = [], [], [], True
        receipts = np.append(received.t_rcv[self._places[rows]], np.inf)
        for i, row in enumerate(rows.tolist()):
            sent = np.maximum(envelopes, cells.area[row])
            more = sent - envelopes
            gain.append(more[:, cells.inside].sum(axis=1))
            aim.append(more.sum(axis=1))
            states, envelopes, whole = _merged(envelopes, sent, cells.begin >= receipts[i + 1])
            after.append(states)
            exact = exact and whole
        everything = cells.area.max(axis=0, initial=0.0)
        return Part(
            level=level,
            states=np.array([len(states) for states in after], dtype=np.int64),
            after=np.concatenate([np.zeros(0, dtype=np.int64), *after]),
            gain=np.concatenate([np.zeros(0), *gain]),
            aim=np.concatenate([np.zeros(0), *aim]),
            facts=float(facts[cells.inside].sum()),
            aim_facts=float(facts.sum()),
            everything=float(everything[cells.inside].sum()),
            exact=exact,
        )


def _cut(received: Received, places: Ints, until: float) -> _Cells:
    """Cut the time of each receiver into cells and integrate every message over them."""
    stream, t_rcv = received.stream[places[0]], received.t_rcv[places]
    parts = []
    for delay, share in zip(received.delay[stream], received.share[stream], strict=True):
        t_end, end = received.t_end - delay, until - delay
        first = min(float(t_rcv[0]), t_end)
        even = np.concatenate((np.linspace(first, t_end, CELLS + 1), np.linspace(t_end, end, CELLS_BEYOND + 1)))
        edges = np.unique(np.concatenate((t_rcv[t_rcv < end], even)))
        begin, close = edges[:-1], edges[1:]
        if len(places) * len(begin) > MAX_AREAS:
            raise ProblemError(f"stream {stream} has {len(places):,} messages in the window: too many for `best`")
        which, cell = (axis.ravel() for axis in np.indices((len(places), len(begin))))
        born = received.t_gen[places[which]] - delay
        start = np.maximum(begin[cell] - born, 0.0)
        area = integrals(
            received.utilities, received.utility[places[which]], start, np.maximum(close[cell] - born, start)
        )
        area *= share * received.scale[places[which]] * (begin[cell] >= t_rcv[which])
        area += 0.0  # 0 and -0 are one value, but not one key
        parts.append((begin, area.reshape(len(places), -1), begin < t_end))
    begin, area, inside = (np.concatenate(column, axis=-1) for column in zip(*parts, strict=True))
    return _Cells(begin, area, inside)


def _merged(states: Floats, sent: Floats, coming: Flags) -> tuple[Ints, Floats, bool]:
    """Return the state that sending leads to from each, all states after it, and whether there was room for all.

    Only the `coming` cells matter.
    """
    known: dict[bytes, int] = {}
    for number, row in enumerate(states[:, coming]):
        known.setdefault(row.tobytes(), number)
    room = np.empty((MAX_STATES, states.shape[1]))
    count, whole = len(states), True
    room[:count] = states
    after: list[int] = []
    for envelope, row in zip(sent, sent[:, coming], strict=True):
        key = row.tobytes()
        if key not in known and count == MAX_STATES:
            known[key], whole = int(np.abs(room[:, coming] - row).sum(axis=1).argmin()), False
        elif key not in known:
            known[key], room[count] = count, envelope
            count += 1
        after.append(known[key])
    return np.array(after, dtype=np.int64), room[:count], whole
