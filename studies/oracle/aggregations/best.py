"""`best`: the columns of rankings tell how far down the list of messages nobody sent anything.

For each ranking m_1, m_2 … m_n with the areas a_1 >= a_2 >= … >= a_n a column z_j tells whether any of the first j
messages is sent:

    gain  Σ_j (a_j − a_{j+1}) · z_j          z_j <= z_{j−1} + (m_j is sent)
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from planner.received import Received
from planner.utility import Floats, Ints
from studies.oracle.aggregations.part import Entries
from studies.oracle.aggregations.rankings import Rankings


@dataclass(frozen=True, slots=True)
class Ranks:
    """The columns z_j of all found, one ranking after the other.

    `message` is the j-th message of the ranking by its index in the problem, `rank` is j − 1, `gain` is a_j − a_{j+1}
    [utility·s].
    """

    message: Ints
    rank: Ints
    gain: Floats

    def rows(self, column: int) -> Entries:
        """Return the entries of the rows z_j − z_{j−1} − m_j <= 0 when the first column z is this one."""
        row = np.arange(len(self.rank))
        follows = row[self.rank > 0]
        return Entries(
            np.concatenate((row, follows, row)),
            np.concatenate((column + row, column + follows - 1, self.message)),
            np.concatenate((np.ones(len(row)), -np.ones(len(follows) + len(row)))),
        )

    def values(self, sends: Floats) -> Floats:
        """Return the greatest z_j that these fractions of the messages of the problem allow."""
        total = np.append(0.0, np.cumsum(sends[self.message]))
        reached: Floats = total[1:] - total[np.arange(len(self.rank)) - self.rank]
        return np.minimum(reached, 1.0)


def build(received: Received, streams: Sequence[Rankings]) -> Ranks:
    """Build the columns of the rankings of all streams."""
    rankings = [ranking for stream in streams for ranking in stream.areas]
    areas = [area for stream in streams for area in stream.areas.values()]
    length = np.array([len(ranking) for ranking in rankings], dtype=np.int64)
    place = np.array([place for ranking in rankings for place in ranking], dtype=np.int64)
    rank = np.arange(len(place)) - np.repeat(np.cumsum(length) - length, length)
    area = np.concatenate([np.zeros(0), *areas])
    follows = np.append(rank, 0)[1:] > 0
    return Ranks(received.index[place], rank, area - np.where(follows, np.append(area, 0.0)[1:], 0.0))


def no_ranks() -> Ranks:
    """Return the columns of a problem without any rankings."""
    return Ranks(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros(0))
