"""Constraints: sliding windows over what is sent (Eq. 4 to 6), checked when a message is added.

Eq. 5 asks at every moment of sending t whether the messages of a window together use at most the limit. Read
backwards, the window is the closed interval [t − T, t]. Open messages are decided in the
order of sending, so adding one can break only the window that ends with it, and those that end with something
already known to be sent later. Both ask the same question: *what was sent since level `first` may use at most
`room`*. The search keeps running totals along its path, so a check is one subtraction: constant time a step.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from planner.columns import Columns
from planner.problem import Constraint, Problem
from planner.utility import Flags, Floats, Ints

CLOSED = 1e-9
"""Windows are closed: what lies on their edge but for rounding is inside [s]."""

SLACK = 1e-9
"""What rounding may add to a sum of uses, as a part of the limit."""

STRETCHED = 16.0
"""A message that exceeds the limit by more than this factor has no exclusion: it would reach over all of the window."""

MOST_EXCLUSIONS = 16
"""So many oversized messages have an exclusion, at most."""


@dataclass(frozen=True, slots=True)
class Rows:
    """In any plan the levels `first[r]` to `last[r]` use at most `capacity[r]` of constraint `of[r]`.

    Unlike a check, a row holds whatever is decided. Only rows that could bind are kept. An oversized message
    counts in them as the limit: nothing else fits into a window with it. Beyond the constraints of the problem, `of`
    names *exclusions*, one for each oversized message: it, and what may not be sent beside it.
    """

    of: Ints
    first: Ints
    last: Ints
    capacity: Floats


@dataclass(frozen=True, slots=True)
class Checks:
    """What must hold for sending the message of each level.

    Level i may be sent when for every check c from `start[i]` to `start[i + 1] − 1` the messages sent at the
    levels `first[c]` to i − 1 use at most `room[c]` of constraint `of[c]`. `use[i, k]` is what level i uses
    of constraint k, `share[i, k]` the same but at most the limit; the columns of exclusions follow. `held[d]` is the
    first level that any check of level d or later still looks back to. `never[i]` tells that no plan can send level i.
    `constraint[j]` is the constraint of column j.
    """

    use: Floats
    share: Floats
    start: Ints
    of: Ints
    first: Ints
    room: Floats
    held: Ints
    never: Flags
    rows: Rows
    constraint: Ints


@dataclass(frozen=True, slots=True)
class _Fixed:
    """What is sent whatever the search decides: facts and other traffic, by time, that use one constraint."""

    time: Floats
    use: Floats
    total: Floats
    """total[j]: the use of the first j."""

    def within(self, begin: Floats, end: Floats) -> Floats:
        """Return what is used in the closed intervals from `begin` to `end`."""
        last = np.searchsorted(self.time, end, side="right")
        return np.asarray(self.total[last] - self.total[np.searchsorted(self.time, begin, side="left")])


@dataclass(frozen=True, slots=True)
class _Exclusion:
    """Of the levels `first` to `last` an oversized message, or others: its use in the column is theirs together."""

    of: int
    first: int
    last: int
    column: Floats


@dataclass(frozen=True, slots=True)
class _Found:
    """Checks of one constraint, not ordered by level; `always`: they bind even if their level is dropped."""

    level: Ints
    of: Ints
    first: Ints
    room: Floats
    always: Flags


def tabulate_checks(problem: Problem) -> Checks:
    """Tabulate all checks of a valid problem."""
    columns = problem.columns
    times, use = columns.t_sent[columns.opened], columns.use[columns.opened]
    found: list[_Found] = []
    for k, constraint in enumerate(problem.constraints):
        fixed = _fixed(columns, k)
        found.append(_own_windows(k, constraint, times, use[:, k], fixed))
        if len(fixed.time) and fixed.time[-1] >= times[0]:
            found.append(_later_windows(k, constraint, times, use[:, k], fixed))
    limits = np.array([constraint.limit for constraint in problem.constraints])
    checks = _assemble(use, np.minimum(use, limits), found)
    apart = [_exclusions(k, c, times, use[:, k], checks.never) for k, c in enumerate(problem.constraints)]
    return _exclude(checks, [each for of_one in apart for each in of_one][:MOST_EXCLUSIONS])


def _exclusions(k: int, constraint: Constraint, times: Floats, use: Floats, never: Flags) -> list[_Exclusion]:
    """Return, for each oversized message that may be sent at all, what cannot be sent beside it."""
    length, _ = stretched(constraint, use)
    found = []
    for level in np.flatnonzero((use > constraint.limit) & (use <= STRETCHED * constraint.limit) & ~never).tolist():
        first = int(np.searchsorted(times, times[level] - length[level], side="left"))
        last = int(np.searchsorted(times, times[level] + constraint.window, side="right")) - 1
        column = np.zeros_like(use)
        column[first : last + 1] = np.minimum(use, constraint.limit)[first : last + 1]
        column[level] = 0.0
        column[level] = np.cumsum(column)[-1]  # adds up one after the other
        if column[level] > 0:
            found.append(_Exclusion(k, first, last, column))
    return found


def _exclude(checks: Checks, exclusions: list[_Exclusion]) -> Checks:
    """Add a row for every exclusion: either the oversized message is sent, or any of the others."""
    if not exclusions:
        return checks
    columns = np.stack([each.column for each in exclusions], axis=1)
    rows, known = checks.rows, checks.use.shape[1]
    return replace(
        checks,
        use=np.hstack((checks.use, columns)),
        share=np.hstack((checks.share, columns)),
        rows=Rows(
            of=np.concatenate((rows.of, known + np.arange(len(exclusions)))),
            first=np.concatenate((rows.first, [each.first for each in exclusions])),
            last=np.concatenate((rows.last, [each.last for each in exclusions])),
            capacity=np.concatenate((rows.capacity, columns.max(axis=0))),
        ),
        constraint=np.concatenate((checks.constraint, [each.of for each in exclusions])),
    )


def stretched(constraint: Constraint, use: Floats) -> tuple[Floats, Floats]:
    """Length and capacity of the windows that end with messages of these uses; longer for oversized ones."""
    factor = np.maximum(use, constraint.limit) / constraint.limit if constraint.limit > 0 else np.ones_like(use)
    capacity = np.maximum(use, constraint.limit) if constraint.limit > 0 else np.zeros_like(use)
    return constraint.window * factor + CLOSED, capacity * (1 + SLACK)


def _fixed(columns: Columns, k: int) -> _Fixed:
    time = np.concatenate((columns.t_sent[columns.sent], columns.traffic_sent))
    use = np.concatenate((columns.use[columns.sent, k], columns.traffic_use[:, k]))
    order = np.lexsort((use, time))
    order = order[use[order] > 0]
    time, use = time[order], use[order]
    return _Fixed(time, use, np.concatenate(([0.0], np.cumsum(use))))


def _own_windows(k: int, constraint: Constraint, times: Floats, use: Floats, fixed: _Fixed) -> _Found:
    """Find the window that ends with each open message."""
    level = np.flatnonzero(use > 0)
    length, capacity = stretched(constraint, use[level])
    begin = times[level] - length
    room = capacity - fixed.within(begin, times[level]) - use[level]
    first = np.searchsorted(times, begin, side="left")
    return _Found(level, np.full(len(level), k), first, room, use[level] <= constraint.limit)


def _later_windows(k: int, constraint: Constraint, times: Floats, use: Floats, fixed: _Fixed) -> _Found:
    """Find the windows that hold open messages and end with something sent later, whatever is decided."""
    length, capacity = stretched(constraint, fixed.use)
    begin = fixed.time - length
    spare = capacity - fixed.within(begin, fixed.time)
    holds = (begin <= times[:, None]) & (times[:, None] <= fixed.time) & (use[:, None] > 0)
    level, end = np.nonzero(_tightest(holds, spare, fixed.use > constraint.limit))
    first = np.searchsorted(times, begin[end], side="left")
    return _Found(level, np.full(len(level), k), first, spare[end] - use[level], np.full(len(level), fill_value=True))


def _tightest(holds: Flags, spare: Floats, oversized: Flags) -> Flags:
    """Leave out windows that an earlier one of the message implies: it reaches farther, with less spare."""
    least = np.minimum.accumulate(np.where(holds, spare, np.inf), axis=1)
    before = np.concatenate((np.full((len(holds), 1), np.inf), least[:, :-1]), axis=1)
    return np.asarray(holds & ((spare < before) | oversized))


def _assemble(use: Floats, share: Floats, found: list[_Found]) -> Checks:
    """Order the checks by level."""
    count = len(use)
    part = found[0] if len(found) == 1 else _merged(found)
    level, of, first, room, always = part.level, part.of, part.first, part.room, part.always
    held = np.arange(count + 1)
    np.minimum.at(held, level, first)
    never = np.zeros(count, dtype=np.bool_)
    never[level[room < 0]] = True
    keep = always & (room >= 0)
    capacity = room[keep] + use[level[keep], of[keep]]
    return Checks(
        use=use,
        share=share,
        start=np.searchsorted(level, np.arange(count + 1)),
        of=of,
        first=first,
        room=room,
        held=np.ascontiguousarray(np.minimum.accumulate(held[::-1])[::-1]),
        never=never,
        rows=_binding(share, Rows(of[keep], first[keep], level[keep], capacity)),
        constraint=np.arange(use.shape[1]),
    )


def _merged(found: list[_Found]) -> _Found:
    """Return all checks by level, those found first of a level first. There may be none."""
    none = np.zeros(0, dtype=np.int64)
    level = np.concatenate([none, *(part.level for part in found)])
    order = np.argsort(level, kind="stable")
    return _Found(
        level[order],
        np.concatenate([none, *(part.of for part in found)])[order],
        np.concatenate([none, *(part.first for part in found)])[order],
        np.concatenate([np.zeros(0), *(part.room for part in found)])[order],
        np.concatenate([none.astype(np.bool_), *(part.always for part in found)])[order],
    )


def _binding(share: Floats, rows: Rows) -> Rows:
    """Leave out the rows that cannot bind, and those that a longer one of the same begin implies."""
    order = np.lexsort((rows.last, rows.first, rows.of))
    of, first, last, capacity = rows.of[order], rows.first[order], rows.last[order], rows.capacity[order]
    total = np.concatenate((np.zeros((1, share.shape[1])), np.cumsum(share, axis=0)))
    keep = total[last + 1, of] - total[first, of] > capacity
    implied = (of[1:] == of[:-1]) & (first[1:] == first[:-1]) & (capacity[1:] <= capacity[:-1])
    keep[:-1] &= ~implied
    return Rows(of[keep], first[keep], last[keep], capacity[keep])


def overfilled(checks: Checks, sends: Sequence[int]) -> frozenset[int]:
    """Return the constraints that sending these levels breaks."""
    sent = np.zeros(len(checks.use), dtype=np.bool_)
    sent[list(sends)] = True
    used = np.concatenate((np.zeros((1, checks.use.shape[1])), np.cumsum(checks.use * sent[:, None], axis=0)))
    level = np.repeat(np.arange(len(sent)), np.diff(checks.start))
    broken = sent[level] & (used[level, checks.of] - used[checks.first, checks.of] > checks.room)
    return frozenset(checks.of[broken].tolist())


def violations(problem: Problem, sends: Iterable[int]) -> list[str]:
    """Return every window in which `sends` make the channel carry more than allowed, by the definition.

    Windows that only facts and traffic overfill are not the fault of a plan and left out.
    """
    chosen = set(sends)
    broken = []
    for k, constraint in enumerate(problem.constraints):
        sent = [(t.t_sent, t.use[k], False) for t in problem.traffic]
        sent += [(m.t_sent, m.use[k], not m.sent) for i, m in enumerate(problem.messages) if m.sent or i in chosen]
        using = [entry for entry in sent if entry[1] > 0]
        for end, use, _ in using:
            stretch = max(1.0, use / constraint.limit) if constraint.limit > 0 else 1.0
            capacity = max(use, constraint.limit) if constraint.limit > 0 else 0.0
            begin = end - constraint.window * stretch - CLOSED
            inside = [entry for entry in using if begin <= entry[0] <= end]
            total = sum(entry[1] for entry in inside)
            if total > capacity * (1 + SLACK) and any(planned for _, _, planned in inside):
                broken.append(f"{constraint.name}: {total:g} of {capacity:g} used in [{begin:g}, {end:g}] s")
    return broken
