"""The programme over all streams: what plans are worth and what the channel allows, as sparse matrices.

    minimise    cost · x                (the negative utility, in units of the greatest gain of a column)
    subject to  balance · x = supply    (a path for each stream through what is sent)
                most · x <= room        (Eq. 5, in limits; then which ranks of `best` are reached)
                lowest <= x <= highest  (facts are sent, banned messages are not)

with one column x for each message of the problem, the fraction that is sent, then the arcs of the paths, then the
ranks.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from planner import Problem
from planner.utility import Floats, Ints
from planner.validation import check_problem
from studies.oracle.aggregations.best import Ranks
from studies.oracle.aggregations.part import Entries, joined
from studies.oracle.evaluation import build_worth
from studies.oracle.scipy import load
from studies.oracle.windows import build_rows


@dataclass(frozen=True, slots=True)
class Programme:
    """The programme of one problem; `balance` and `most` are sparse arrays of SciPy."""

    cost: Floats
    balance: Any
    supply: Floats
    most: Any
    room: Floats
    lowest: Floats
    highest: Floats
    messages: int
    """The number of columns that are messages."""
    unit: float
    """What a cost of 1 is worth [utility·s]: weights span decades, tolerances are absolute."""
    skips: Ints
    """How many messages the arc of each column skips on its way to another, or are of a better rank; else 0."""
    ranks: Ranks
    """What the last columns are."""

    def sends(self, x: Floats) -> Floats:
        """Return the fraction of each message of the problem that a solution sends."""
        return np.clip(x[: self.messages], 0.0, 1.0)

    def utility(self, cost: float) -> float:
        """Return what a solution of this cost is worth [utility·s]."""
        return -cost * self.unit


def build_programme(problem: Problem, every: float = 0.0) -> Programme:
    """Build the programme, with windows that end `every` [s] apart at least.

    Raises ProblemError for a problem without meaning, OracleUnavailable without SciPy, OracleError when an aggregation
    of the caller has too many states.
    """
    check_problem(problem)
    (paths, ranks), rows = build_worth(problem), build_rows(problem, every)
    facts = np.array([m.sent for m in problem.messages], dtype=np.bool_)
    gain = np.concatenate((paths.gain, ranks.gain))
    columns, windows = len(gain), len(rows.room)
    unit = float(np.abs(gain).max(initial=0.0)) or 1.0
    lowest, highest = np.zeros(columns), np.ones(columns)
    lowest[: len(facts)] = facts
    highest[: len(facts)] = facts | ~rows.banned
    reached = ranks.rows(len(paths.gain))
    below = Entries(reached.row + windows, reached.column, reached.value)
    most = joined([Entries(rows.row, rows.message, rows.share), below])
    return Programme(
        cost=-gain / unit,
        balance=_matrix(paths.balance, (len(paths.supply), columns)),
        supply=paths.supply,
        most=_matrix(most, (windows + len(ranks.rank), columns)),
        room=np.concatenate((rows.room, np.zeros(len(ranks.rank)))),
        lowest=lowest,
        highest=highest,
        messages=len(facts),
        unit=unit,
        skips=np.concatenate((paths.skips, ranks.rank)),
        ranks=ranks,
    )


def _matrix(entries: Entries, shape: tuple[int, int]) -> Any:
    return load("sparse").csc_array((entries.value, (entries.row, entries.column)), shape=shape)
