"""The constraint windows as rows of a programme (Eq. 5, 6): what open messages may use beside what is fixed.

The predicate is the planner's: the closed window that ends with each thing sent carries at most the limit;
one that ends with a message of more than the limit is stretched to use / limit × window and carries nothing
else. One row for each moment at which anything may be sent says all of the first kind. In it an oversized
message counts as the whole limit: if it is sent, the row leaves no room for others, as the predicate does.
The stretched part of an oversized message's window gets rows of its own, one for each ordinary window
within.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from planner import Constraint, Problem
from planner.constraints import CLOSED, SLACK
from planner.utility import Flags, Floats, Ints


@dataclass(frozen=True, slots=True)
class Rows:
    """Sparse rows: the sum over entries of `share` × (message sent) of row r is at most `room[r]`, in limits.

    Entry e is of row `row[e]` and message `message[e]` of the problem. `banned[i]`: message i may not be
    sent at all.
    """

    row: Ints
    message: Ints
    share: Floats
    room: Floats
    banned: Flags


@dataclass(frozen=True, slots=True)
class _Row:
    message: Ints
    share: Floats
    room: float


@dataclass(frozen=True, slots=True)
class _Uses:
    """What uses one constraint, by time: open messages (`message` is their index) and what is fixed (−1)."""

    time: Floats
    share: Floats
    """In limits; more than 1 for oversized ones."""
    message: Ints
    window: float

    @property
    def open(self) -> Flags:
        return np.asarray(self.message >= 0)

    def since(self, begin: float) -> int:
        return int(np.searchsorted(self.time, begin - CLOSED, side="left"))

    def until(self, end: float) -> int:
        return int(np.searchsorted(self.time, end, side="right"))


def build_rows(problem: Problem, every: float = 0.0) -> Rows:
    """Build the rows of all constraints of a valid problem; only those of windows that end `every` [s] apart at least.

    With fewer rows no less is allowed: what bounds a plan under them bounds it under all.
    """
    banned = np.zeros(len(problem.messages), dtype=np.bool_)
    rows: list[_Row] = []
    for k, constraint in enumerate(problem.constraints):
        if constraint.limit > 0:
            uses = _uses(problem, k, constraint)
            banned[_banned(uses)] = True
            rows += _ordinary(uses, every)
            rows += _stretched(uses)
        else:
            banned |= np.array([m.use[k] > 0 and not m.sent for m in problem.messages])
    counts = [len(row.message) for row in rows]
    return Rows(
        row=np.repeat(np.arange(len(rows)), counts),
        message=np.concatenate([np.zeros(0, dtype=np.int64), *(row.message for row in rows)]),
        share=np.concatenate([np.zeros(0), *(row.share for row in rows)]),
        room=np.array([row.room for row in rows], dtype=np.float64),
        banned=banned,
    )


def _uses(problem: Problem, k: int, constraint: Constraint) -> _Uses:
    found = [(m.t_sent, m.use[k], -1 if m.sent else i) for i, m in enumerate(problem.messages) if m.use[k] > 0]
    found += [(t.t_sent, t.use[k], -1) for t in problem.traffic if t.use[k] > 0]
    found.sort()
    return _Uses(
        time=np.array([time for time, _, _ in found], dtype=np.float64),
        share=np.array([use for _, use, _ in found], dtype=np.float64) / constraint.limit,
        message=np.array([message for _, _, message in found], dtype=np.int64),
        window=constraint.window,
    )


def _ordinary(uses: _Uses, every: float) -> Iterator[_Row]:
    """Yield a row for each window, but for those that the next one contains, or that end too soon after another."""
    ends = _apart(np.unique(uses.time), every)
    begins = [uses.since(end - uses.window) for end in ends]
    for end, begin, next_begin in zip(ends, begins, [*begins, len(uses.time)][1:], strict=True):
        if begin < next_begin:
            yield from _row(uses, begin, uses.until(end))


def _apart(ends: Floats, every: float) -> Floats:
    """Return the ends that lie so far apart at least [s]."""
    if every <= 0.0 or not len(ends):
        return ends
    return ends[np.unique(np.floor((ends - ends[0]) / every), return_index=True)[1]]


def _row(uses: _Uses, begin: int, end: int, oversized: int | None = None) -> Iterator[_Row]:
    """Yield the row of the places `begin` to `end` − 1; beside an oversized message they have no room."""
    message, share, opened = (
        uses.message[begin:end],
        np.minimum(uses.share[begin:end], 1.0),
        uses.open[begin:end],
    )
    room = 1.0 + SLACK - float(uses.share[begin:end][~opened].sum())
    keep = opened & (np.arange(begin, end) != oversized)
    message, share = message[keep], share[keep]
    if oversized is not None:
        message, share = np.append(message, uses.message[oversized]), np.append(share, 1.0)
    if share.sum() > room:
        yield _Row(message, share, max(room, 0.0))


def _stretched(uses: _Uses) -> Iterator[_Row]:
    """Yield the rows of the windows of open oversized messages, which reach farther back."""
    for place in np.flatnonzero((uses.share > 1.0) & uses.open):
        end = uses.time[place]
        begin = uses.since(end - uses.window * uses.share[place])
        stop = begin
        while stop < uses.until(end):
            # Ordinary windows cover the stretched one; each may be full, but not beside the message.
            start, stop = stop, uses.until(uses.time[stop] + uses.window)
            yield from _row(uses, start, min(stop, uses.until(end)), oversized=int(place))


def _banned(uses: _Uses) -> Ints:
    """Return open messages that may not be sent because of what is fixed, which rows cannot say.

    Those with anything fixed in their stretched window, and those in the stretched window of anything fixed.
    """
    banned: list[int] = []
    fixed = uses.time[~uses.open]
    for place in np.flatnonzero(uses.share > 1.0):
        end = uses.time[place]
        begin = end - uses.window * uses.share[place] - CLOSED
        if not uses.open[place]:
            banned += uses.message[(uses.time >= begin) & (uses.time <= end) & uses.open].tolist()
        elif ((fixed >= begin) & (fixed <= end)).any():
            banned.append(int(uses.message[place]))
    return np.array(banned, dtype=np.int64)
