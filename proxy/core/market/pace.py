"""How long what is sent keeps the channel busy: large samples wait at their robot until it has carried those before.

A window says how much may be sent, not when. Eight robots with cameras that fill nine tenths of a channel send two or
three frames at one moment now and then, which come late then, each by what the others take. Where each waits until
the channel is free, the newest frame goes. In simulation (24 Mbit/s offered, 6 carried, three seeds) frames took 115
to 136 ms to arrive by the median, and 51 now; the team reached 86.2 % of the offline optimum's utility, and 91.5 now;
96.1 on a channel on which nobody waits for others. Where digests wait behind whole frames robots hear of each other
late: there it gains 0.3 to 1 %, and 2 to 6 % of the windows are over the limit instead of 1.

Samples that prices decide on wait, too: at 12 Mbit/s carried the team reached 93.4 % where it was 91.1, when robots
paced themselves from the start besides.

What a sample occupies is measured: what it takes beyond a digest. Where a channel is much faster than its limit nobody
waits.
"""

import math
from collections.abc import Iterable, Sequence

from proxy.core.market.tuning import TUNING
from proxy.core.model.limits import Limit, Send, use_of
from proxy.core.view.stream import Stream
from proxy.core.view.view import SharedView


def pace_part(view: SharedView, stream: Stream, limits: tuple[Limit, ...]) -> float:
    """Return how long a sample of ours keeps the channel busy, as a part of what it takes at the limits' pace.

    No more than `TUNING.paced`: what limits allow is carried, and what was measured holds waits behind others, too.
    Nothing while nobody has told yet what samples take, as an operator of eight robots does after 2 to 5 s. Where
    robots began with it as soon as digests waited, the first seconds were better (50, 85 and 95 % of the optimum
    instead of 50, 79 and 88), but four robots showed red frames 2.5 to 2.7 times as often as others, where it is
    2.3 now and 2.2 in the optimum, with equal utility.
    """
    size, copies = round(stream.sizes.mean), view.subscribers.copies(stream)
    slowest = at_pace(use_of(size, copies, limits), limits)
    took = view.paths.on_air(view.subscribers.gaining(stream), size)
    if took is None or slowest <= 0.0:
        return 0.0
    part = took * copies / slowest
    return min(TUNING.paced, part) if part >= TUNING.paced_least else 0.0


def at_pace(use: Sequence[float], limits: tuple[Limit, ...]) -> float:
    """Return how long a message takes that uses so much, at the pace of the slowest limit that robots share [s]."""
    return max([u / c.limit * c.window for u, c in zip(use, limits, strict=True) if c.shared], default=0.0)


def carried(sends: Iterable[Send], limits: tuple[Limit, ...], part: float) -> float:
    """Return when the channel has carried these sends, each in this part of its time at the limits' pace [s].

    −∞ where there are none.
    """
    free = -math.inf
    for t, use in sorted(sends):
        free = max(free, t) + part * at_pace(use, limits)
    return free
