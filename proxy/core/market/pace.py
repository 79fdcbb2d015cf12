"""How long what is sent keeps the channel busy: large samples wait at their robot until it has carried those before.

A window says how much may be sent, not when; as each waits until the channel is free, the newest frame goes. Frames of
eight robots took 115 to 136 ms by the median (24 Mbit/s offered, 6 carried, three seeds) and take 51; the team reaches
91.5 % of the offline optimum instead of 86.2. What a sample occupies is measured: what it takes beyond a digest.
"""

import math
from collections.abc import Iterable, Sequence

from proxy.core.market.tuning import TUNING
from proxy.core.model.limits import Limit, Send, use_of
from proxy.core.view.stream import Stream
from proxy.core.view.view import SharedView


def pace_part(view: SharedView, stream: Stream, limits: tuple[Limit, ...]) -> float:
    """Return how long a sample of ours keeps the channel busy, as a part of what it takes at the limits' pace.

    At most `TUNING.paced`, as what was measured holds waits, and nothing while nobody has told yet what samples take.
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
    """Return when the channel has carried these sends, each in this part of its time [s]; −∞: there are none."""
    free = -math.inf
    for t, use in sorted(sends):
        free = max(free, t) + part * at_pace(use, limits)
    return free
