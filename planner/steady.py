"""The steady state: every stream sends at the regular interval that pays best when limits have a price.

Sending more often earns less and less: going from one interval to the next shorter one buys more sends per second at a
*marginal* value each. The channel is given away in the order of what is paid for a unit of it; the price is what the
last unit earns (water-filling).
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from planner.utility import Flags, Floats, Ints

INTERVALS = np.array([1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 25, 32, 50, 100, 300], dtype=np.float64)
"""The intervals between sends that are tried for a stream, in its mean intervals between messages."""

SWEEPS = 3
"""How often the prices of several constraints are fitted to each other."""


ROUNDING = 1e-9
"""What rounding may change of a sum, as a part of it: no choice depends on less."""


@dataclass(frozen=True)
class Steady:
    """The streams that go on, and what each earns and uses by the interval between its sends.

    `value[i, j]` and `rate[i, j]`: utility per second and sends per second at interval j; `use[i, k]` per send.
    """

    stream: Ints
    value: Floats
    rate: Floats
    use: Floats

    @property
    def apart(self) -> Floats:
        """The intervals [s]."""
        return 1.0 / self.rate

    def charge(self, price: Floats) -> Floats:
        """Return what a message of each stream is charged at the price of a unit of each constraint [utility·s]."""
        return np.asarray((self.use * price).sum(axis=1))

    def pays_best(self, net: Floats) -> tuple[Ints, Flags]:
        """Return the shortest interval of the greatest `net[i, j]` for each stream, and whether it pays at all."""
        rounding = ROUNDING * self.value.max(axis=1)
        most = net.max(axis=1)
        return (net >= (most - rounding)[:, None]).argmax(axis=1), most > rounding

    @cached_property
    def marginal(self) -> tuple[Floats, Floats]:
        """What one more send earns on the way to each interval [utility·s], and how many more there are [1/s].

        What the shorter intervals earn counts for the longer ones, too: a stream comes to them at once.
        """
        more, earned = self.rate.copy(), self.value.copy()
        more[:, :-1] -= self.rate[:, 1:]
        earned[:, :-1] -= self.value[:, 1:]
        return np.maximum.accumulate(earned / more, axis=1), more


def clearing_prices(steady: Steady, offered: Floats) -> Floats:
    """Return the price of each constraint at which the streams use up what is `offered` of it a second, no more."""
    marginal, more = steady.marginal
    price = np.zeros(len(offered))
    for _ in range(SWEEPS if len(price) > 1 else 1):
        for k, amount in enumerate(offered):
            price[k] = 0.0  # so that the others alone are charged
            users = steady.use[:, k] > 0
            paid = (marginal - steady.charge(price)[:, None])[users] / steady.use[users, k, None]
            wanted = (more * steady.use[:, k, None])[users]
            price[k] = _clearing(paid.ravel(), wanted.ravel(), float(amount))
    return price


def _clearing(paid: Floats, wanted: Floats, offered: float) -> float:
    """Return the price at which of what is wanted no more than what is offered is bought; 0 when all fits."""
    order = np.argsort(-paid, kind="stable")
    bought = np.cumsum(wanted[order])
    last = int(np.searchsorted(bought, offered * (1.0 + ROUNDING), side="right"))
    return max(float(paid[order[last]]), 0.0) if last < len(order) else 0.0
