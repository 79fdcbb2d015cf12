"""Windows in which more was sent than a limit allows, counted by the sample that ends them."""

import numpy as np

from planner.constraints import CLOSED, SLACK
from planner.utility import Flags
from studies.replay.outcomes import Columns, Outcomes


def violating(outcomes: Outcomes, columns: Columns) -> Flags:
    """Return of each sample whether somebody decided to send it although its window then held more than a limit.

    Samples that nobody decides on count in windows. One that exceeds a limit alone has a window that is longer by as
    much, for itself (Eq. 5 and 6).
    """
    mission, streams = outcomes.mission, outcomes.streams
    order = np.flatnonzero(columns.sent)
    order = order[np.argsort(columns.t_sent[order], kind="stable")]
    times, found = columns.t_sent[order], np.zeros(len(columns.t), dtype=np.bool_)
    planned = np.array([streams[s].planned for s in columns.stream[order].tolist()], dtype=np.bool_)
    sent = zip(columns.size[order].tolist(), columns.stream[order].tolist(), strict=True)
    uses = np.array([mission.use(size, streams[s].robot) for size, s in sent]).reshape(len(order), len(mission.limits))
    for k, limit in enumerate(mission.limits):
        use, most, window = uses[:, k], limit.measure.limit, limit.measure.window
        begins = np.searchsorted(times, times - window * np.maximum(use / most, 1.0) - CLOSED)
        sums = np.append(0.0, np.cumsum(use))
        held = sums[np.searchsorted(times, times, side="right")] - sums[begins]
        over = planned & (use > 0.0) & (held > np.maximum(most, use) * (1.0 + SLACK))
        found[order[over]] = True
    return found
