"""The programme over all streams: longest paths that share the constraint windows, as sparse matrices.

    minimise    cost · x                (the negative utility, in units of the greatest gain of an arc)
    subject to  balance · x = supply    (a path for each stream; a message is sent as far as paths pass it)
                windows · x <= room      (Eq. 5, in limits)
                lowest <= x <= highest  (facts are sent, banned messages are not)

with one column x for each arc of the network, then one for each message of the problem: the fraction that
is sent.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from planner import Problem
from planner.utility import Flags, Floats, Ints
from planner.validation import check_problem
from studies.oracle.network import Network, build_network
from studies.oracle.scipy import load
from studies.oracle.windows import Rows, build_rows


@dataclass(frozen=True, slots=True)
class Programme:
    """The programme of one problem; `balance` and `windows` are sparse arrays of SciPy."""

    cost: Floats
    balance: Any
    supply: Floats
    windows: Any
    room: Floats
    lowest: Floats
    highest: Floats
    arcs: int
    """The number of columns that are arcs."""
    unit: float
    """What a cost of 1 is worth [utility·s]: weights span decades, tolerances are absolute."""
    skips: Ints
    """How many messages the arc of each column skips on its way to another; 0 for other columns."""

    def sends(self, x: Floats) -> Floats:
        """Return the fraction of each message of the problem that a solution sends."""
        return np.clip(x[self.arcs :], 0.0, 1.0)

    def utility(self, cost: float) -> float:
        """Return what a solution of this cost is worth [utility·s]."""
        return -cost * self.unit


def build_programme(problem: Problem) -> Programme:
    """Build the programme; raise ProblemError for one without meaning, OracleUnavailable without SciPy."""
    check_problem(problem)
    network, rows = build_network(problem), build_rows(problem)
    facts = np.array([m.sent for m in problem.messages], dtype=np.bool_)
    arcs = len(network.gain)
    unit = float(network.gain.max(initial=0.0)) or 1.0
    balance, supply = _balance(network)
    return Programme(
        cost=np.concatenate((-network.gain / unit, np.zeros(len(facts)))),
        balance=balance,
        supply=supply,
        windows=_matrix(rows.row, arcs + rows.message, rows.share, (len(rows.room), arcs + len(facts))),
        room=rows.room,
        lowest=np.concatenate((np.zeros(arcs), facts.astype(np.float64))),
        highest=_highest(arcs, facts, rows),
        arcs=arcs,
        unit=unit,
        skips=np.concatenate((_skips(network), np.zeros(len(facts), dtype=np.int64))),
    )


def _highest(arcs: int, facts: Flags, rows: Rows) -> Floats:
    return np.concatenate((np.ones(arcs), np.where(rows.banned & ~facts, 0.0, 1.0)))


def _skips(network: Network) -> Ints:
    count = len(network.message)
    direct = (network.tail < count) & (network.head < count)
    return np.where(direct, network.head - network.tail - 1, 0)


def _balance(network: Network) -> tuple[Any, Floats]:
    """Demand that what flows into an empty node flows out, and through a message the fraction sent.

    A row for each node, then one more for what flows out of each message.
    """
    count, arc = len(network.message), np.arange(len(network.gain))
    place, sent = np.arange(count), len(arc) + network.message
    outflow = np.where(network.tail < count, network.tail + network.nodes, network.tail)
    row = np.concatenate((network.head, outflow, place, place + network.nodes))
    column = np.concatenate((arc, arc, sent, sent))
    value = np.concatenate((np.ones(len(arc)), -np.ones(len(arc)), -np.ones(count), np.ones(count)))
    supply = np.zeros(network.nodes + count)
    supply[network.source] -= 1.0
    supply[network.sink] += 1.0
    return _matrix(row, column, value, (len(supply), len(arc) + count)), supply


def _matrix(row: Ints, column: Ints, value: Floats, shape: tuple[int, int]) -> Any:
    return load("sparse").csc_array((value, (row, column)), shape=shape)
