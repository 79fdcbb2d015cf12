"""What `current` takes off: a message shows more than the newest one generated, sent or not, is worth.

While the scale w_s of the message shown exceeds w_n, that of the newest one generated, `u(0) · (w_s − w_n)` is lost a
second: the age of incorrect information (Maatouk et al. 2019) beside the age of information. What is generated does
not depend on decisions, so w_n steps at times that are known, and what a message loses between two times is a sum.
"""

import numpy as np

from planner.errors import ProblemError
from planner.problem import Aggregation, Problem
from planner.utility import Floats, Ints, MessageUtility, Power


def initial(utility: MessageUtility) -> float:
    """Return the value of a message at the age 0; infinite where it has no limit [1/s]. Raises ProblemError."""
    if isinstance(utility, Power):
        return np.inf
    try:
        return float(utility.value(np.zeros(1))[0])
    except Exception as error:  # a utility of the caller's may fail
        kind = type(utility).__name__
        raise ProblemError(f"utility {kind}.value() failed: {type(error).__name__}: {error}") from error


class Excess:
    """What the messages of a problem lose a second, at any time, in its streams of `current`; 0 in all others.

    From `since[i, k]` on, up to `since[i, k + 1]`, the newest message of stream i has `scale[i, k]`; before the first
    is known it counts as there.
    """

    def __init__(self, problem: Problem) -> None:
        columns = problem.columns
        self._steps = _steps(problem)
        width = max(map(len, self._steps.values()), default=1)
        self._since = np.full((len(problem.streams), width + 1), np.inf)
        self._scale = np.full((len(problem.streams), width), np.inf)
        for stream, steps in self._steps.items():
            self._since[stream, : len(steps)], self._scale[stream, : len(steps)] = zip(*steps, strict=True)
            self._since[stream, 0] = -np.inf
        needed = np.zeros(len(columns.utilities), dtype=np.bool_)
        needed[columns.utility[np.isin(columns.stream, list(self._steps))]] = True
        each = [initial(utility) if need else 0.0 for utility, need in zip(columns.utilities, needed, strict=True)]
        self._lost = np.array(each)[columns.utility]
        """By message: what each unit of its scale in excess loses a second [1/s]."""
        self._columns = columns

    def lost(self, which: Ints, begin: Floats, end: Floats) -> Floats:
        """Return what messages of the problem lose where they are shown from `begin` to `end` [utility·s]."""
        streams, scale = self._columns.stream[which], self._columns.scale[which]
        total = np.zeros(len(which))
        for k in range(self._scale.shape[1]):
            over = np.maximum(scale - self._scale[streams, k], 0.0)
            span = np.minimum(end, self._since[streams, k + 1]) - np.maximum(begin, self._since[streams, k])
            total += over * np.maximum(span, 0.0)
        return np.asarray(self._lost[which] * total)

    def finally_lost(self) -> Floats:
        """Return what each message of the problem loses a second once all others are generated [1/s]."""
        last = np.full(len(self._scale), np.inf)
        for stream, steps in self._steps.items():
            last[stream] = steps[-1][1]
        return np.asarray(self._lost * np.maximum(self._columns.scale - last[self._columns.stream], 0.0))


def _steps(problem: Problem) -> dict[int, list[tuple[float, float]]]:
    """Return when the scale of the newest message of each stream of `current` changes [s], and to what."""
    generated: dict[int, list[tuple[float, float]]] = {
        at: [] if stream.newest is None else [stream.newest]
        for at, stream in enumerate(problem.streams)
        if stream.aggregation is Aggregation.CURRENT
    }
    for m in problem.messages:
        if m.stream in generated:
            generated[m.stream].append((m.t_gen, m.scale))
    steps: dict[int, list[tuple[float, float]]] = {}
    for stream, each in generated.items():
        for t, scale in sorted(each, key=lambda one: one[0]):
            known = steps.setdefault(stream, [(t, scale)])
            if known[-1][1] != scale:
                known.append((t, scale))
    return steps
