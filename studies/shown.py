"""What a screen of `current` loses: the time it shows a sample of more worth than the newest one generated.

Written apart from the planner's, so that each checks the other.
"""

from __future__ import annotations

import numpy as np

from planner.utility import Floats, Ints


def excess(
    shown: tuple[Floats, Floats], generated: tuple[Floats, Floats], end: float, cuts: Floats | None = None
) -> tuple[Floats, Ints, Floats]:
    """Return what is shown too much, piece by piece: when each begins [s], what is shown in it, and scale × time.

    `shown` are times of receipt and scales in the order of receipt, `generated` times and scales of all samples in
    the order of generation, whether received or not. Pieces end at `end` and also at `cuts` [s].
    """
    t_rcv, scale = shown
    t_gen, made = generated
    times = np.concatenate((t_rcv, t_gen, np.zeros(0) if cuts is None else cuts, [end]))
    edges = np.unique(times[(times >= t_rcv[0]) & (times <= end)])
    begins = edges[:-1]
    which = np.searchsorted(t_rcv, begins, side="right") - 1
    newest = np.maximum(np.searchsorted(t_gen, begins, side="right") - 1, 0)
    return begins, which, np.maximum(scale[which] - made[newest], 0.0) * np.diff(edges)
