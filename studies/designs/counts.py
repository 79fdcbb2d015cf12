"""How many nodes a whole tree has, by level: free, with constraints (Eq. 4 to 6), with tantamount nodes as one (Eq. 7).

The messages are those of a regular team: its streams generate in turn, each constraint window holds `held` messages in
a row, and at most `most` of them may be sent.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from math import comb, prod

import numpy as np

STREAM_BITS = 3
"""For the number of the last message of a stream, 0 for none: seven messages of each at most."""


@dataclass(frozen=True, slots=True)
class Regular:
    """A regular team and its limit; the paper's k is `held`, and its r, which is never reached, `most` + 1."""

    streams: int
    held: int
    most: int

    def claimed(self, level: int) -> float | None:
        """Return the paper's number of nodes of a level (§3.2.1); None before the first window is full."""
        k, r, i = self.held, self.most + 1, level
        if i < k - 1:
            return None
        too_many = sum(comb(k, j) for j in range(r, k + 1))
        return float(2.0**i - 2.0 ** (i - k) * too_many - (2.0 ** (i - k) - 1) * comb(k - 1, r - 1))

    def generated(self, level: int) -> list[int]:
        """Return how many of the first messages are of each stream, n_p of Eq. 8."""
        return [(level - stream + self.streams - 1) // self.streams for stream in range(self.streams)]


@dataclass(frozen=True, slots=True)
class Nodes:
    """The nodes of one level of a whole tree.

    `free` without any reduction, `claimed` by the paper's formula, `allowed` by the constraint. `printed` are the
    states of Eq. 8, `states` with n_p + 1 in it: nothing received yet is a state, too. `both` are states that a plan
    within the constraint reaches (`paper`), `exact` those told apart by what the constraint window holds (`exact`).
    """

    level: int
    free: int
    claimed: float | None
    allowed: int
    printed: int
    states: int
    both: int
    exact: int


def count(team: Regular, levels: int) -> Iterator[Nodes]:
    """Yield the nodes of the first levels below the root; at most seven messages of each stream."""
    window = (1 << (team.held - 1)) - 1
    plans: Counter[int] = Counter({0: 1})  # by which of the last messages are sent, a bit each
    states = np.zeros(1, dtype=np.int64)  # the last message of each stream, then the same bits
    for level in range(1, levels + 1):
        plans = _decided(plans, team.most, window)
        states = _states(states, team, level, window)
        generated = team.generated(level)
        yield Nodes(
            level=level,
            free=2**level,
            claimed=team.claimed(level),
            allowed=plans.total(),
            printed=prod(generated),
            states=prod(n + 1 for n in generated),
            both=len(np.unique(states >> (team.held - 1))),
            exact=len(states),
        )


def _decided(plans: Counter[int], most: int, window: int) -> Counter[int]:
    """Let every plan drop the next message, and send it where that is allowed."""
    longer: Counter[int] = Counter()
    for sent, number in plans.items():
        longer[(sent << 1) & window] += number
        if sent.bit_count() < most:
            longer[(sent << 1 | 1) & window] += number
    return longer


def _states(
    states: "np.typing.NDArray[np.int64]", team: Regular, level: int, window: int
) -> "np.typing.NDArray[np.int64]":
    """Return the states after one more message."""
    bits = team.held - 1
    sent, last = states & window, states >> bits
    dropped = last << bits | (sent << 1) & window
    stream, number = (level - 1) % team.streams, (level - 1) // team.streams + 1
    at = STREAM_BITS * stream
    mask = ((1 << STREAM_BITS) - 1) << at
    allowed = np.bitwise_count(sent) < team.most
    renewed = (last[allowed] & ~mask) | (number << at)
    return np.unique(np.concatenate((dropped, renewed << bits | (sent[allowed] << 1 | 1) & window)))
