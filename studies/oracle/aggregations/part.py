"""Paths: columns and rows that say what the messages of some streams are worth.

The first columns of every part are the messages of the problem: the fraction of each that is sent. Arcs of its own
follow. All lie between 0 and 1, and `balance · x = supply` leaves the arcs just the values that go with what is sent.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from planner.utility import Floats, Ints


@dataclass(frozen=True, slots=True)
class Entries:
    """Entries of a sparse matrix."""

    row: Ints
    column: Ints
    value: Floats


def no_entries() -> Entries:
    """Return the entries of a matrix that has none."""
    return Entries(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros(0))


def arcs(column: Ints, tail: Ints, head: Ints) -> Entries:
    """Return the entries of arcs in the balance of nodes: what flows in less what flows out."""
    ones = np.ones(len(column))
    return joined([Entries(head, column, ones), Entries(tail, column, -ones)])


def joined(parts: Sequence[Entries]) -> Entries:
    """Put entries of one matrix together."""
    return Entries(
        np.concatenate([part.row for part in parts]),
        np.concatenate([part.column for part in parts]),
        np.concatenate([part.value for part in parts]),
    )


@dataclass(frozen=True, slots=True)
class Part:
    """What sending is worth to some streams."""

    gain: Floats
    """What each column is worth, those of the messages first [utility·s]."""
    balance: Entries
    supply: Floats
    skips: Ints
    """How many messages the arc of each column skips on its way to another; 0 for other columns."""


def join(messages: int, parts: Sequence[Part]) -> Part:
    """Put the columns and rows of different streams together; there are so many `messages` in the problem."""
    balance, columns, rows = [no_entries()], 0, 0
    for part in parts:
        column = part.balance.column + np.where(part.balance.column < messages, 0, columns)
        balance.append(Entries(part.balance.row + rows, column, part.balance.value))
        columns += len(part.gain) - messages
        rows += len(part.supply)
    alone = sum((part.gain[:messages] for part in parts), start=np.zeros(messages))
    return Part(
        gain=np.concatenate((alone, *(part.gain[messages:] for part in parts))),
        balance=joined(balance),
        supply=np.concatenate([np.zeros(0), *(part.supply for part in parts)]),
        skips=np.concatenate([np.zeros(messages, dtype=np.int64), *(part.skips[messages:] for part in parts)]),
    )
