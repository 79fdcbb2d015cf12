"""What others may just have sent of what nobody disputes, and we have not heard of yet.

Eight robots with streams of 2 to 10 Hz had 10 % of the windows over the limit without it (2 and 20 ms, broadcast), and
have 7 and 5, for 3 and 2 % of the utility.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

from proxy.core.market.standing import Amounts, Row


class UnderWay(NamedTuple):
    """What others send of each limit: the mean, and the variance, of what they use in a second."""

    mean: Amounts = ()
    variance: Amounts = ()

    @classmethod
    def of(cls, sending: Sequence[tuple[Row, float]], limits: int) -> "UnderWay":
        """Return it of streams of others, each with how far apart it sends [s], under so many limits."""
        mean = tuple([sum([row.use[k] / apart for row, apart in sending]) for k in range(limits)])
        return cls(mean, tuple([sum([row.use[k] ** 2 / apart for row, apart in sending]) for k in range(limits)]))

    def beside(self, use: Amounts, time: float) -> Amounts:
        """Return the use of a message, and of what is under way beside it where news take so long [s]."""
        if len(use) != len(self.mean):
            return use
        return tuple(
            [
                u + time * mean + math.sqrt(time * variance) if u > 0.0 else u
                for u, mean, variance in zip(use, self.mean, self.variance, strict=True)
            ]
        )
