"""Bursts: several samples close together, then a pause, and again."""

from collections.abc import Sequence
from itertools import pairwise

from proxy.core.forecast.patterns import Memoryless, Pattern, Periodic, Span, evenly, merged
from proxy.core.forecast.rhythm import Numbered, Rhythm, fit
from proxy.core.forecast.tuning import TUNING


class Bursts(Pattern):
    """`size` samples every `step` [s], and that whenever a burst starts; `begun` samples of the last one are known."""

    def __init__(self, starts: Rhythm, size: int, step: float, last: float, begun: int) -> None:
        super().__init__(f"bursts {size} {step:.6g}", starts.period / size, starts.jitter, starts.period)
        self.starts = starts
        self.size = size
        self.step = step
        self.last = last
        self.begun = begun

    def joined(self, t: float) -> "Bursts | None":
        """Return the bursts with one more sample at `t` [s] in the last one; None when it is none of it."""
        if t > self.last + TUNING.burst_pause * self.step or self.begun >= TUNING.burst_sizes * self.size:
            return None
        return Bursts(self.starts, self.size, self.step, t, self.begun + 1)

    def expect(self, span: Span) -> list[float]:
        """Return what is missing of the last burst, and the members of those to come."""
        rest = evenly(self.last + self.step, self.step, span.until, self.size - self.begun)
        since = Span(span.now, max(span.after, self.last), span.until, span.most // self.size + 2)
        regular = self.starts.looseness <= TUNING.no_rhythm
        starts = (Periodic(self.starts) if regular else Memoryless(self.starts.period)).expect(since)
        return merged([rest, *(evenly(t, self.step, span.until, self.size) for t in starts)], span)


def bursts_in(past: Sequence[Numbered], *, whole: bool) -> Bursts | None:
    """Return the bursts in numbered times; None when there are none. `whole` says that the first one is complete."""
    times = [t for _, t in past]
    gaps = [b - a for a, b in pairwise(times)]
    longest_step = _longest_step(gaps)
    if longest_step is None:
        return None
    heads = [0, *(i + 1 for i, gap in enumerate(gaps) if gap > longest_step)]
    rest = past[-1][0] - past[heads[-1]][0] + 1
    sizes = [past[b][0] - past[a][0] for a, b in pairwise(heads)][0 if whole else 1 :]
    size = round(sum(sizes) / max(1, len(sizes)))
    few = len(sizes) < TUNING.run and max(*sizes, rest, heads[1]) > TUNING.burst_sizes * min(sizes, default=0)
    starts = fit([(i, times[head]) for i, head in enumerate(heads)][0 if whole else 1 :])
    endless = rest > TUNING.burst_sizes * max(sizes, default=0)
    if starts is None or size < 2 or few or endless:
        return None
    steps = sorted([gap for gap in gaps if gap <= longest_step])
    return Bursts(starts, size, steps[len(steps) // 2], times[-1], rest)


def reported_bursts(words: Sequence[str], period: float, last: float) -> Bursts | None:
    """Return the bursts of which a robot reported size and step, as `Bursts.kind` writes them; None for nonsense."""
    try:
        size, step = int(words[1]), float(words[2])
    except (IndexError, ValueError):
        return None
    if not (2 <= size <= TUNING.most_members and 0.0 < step < period):
        return None
    return Bursts(Rhythm(size * period, last - (size - 1) * step, 1, 0.0, 1), size, step, last, size)


def _longest_step(gaps: Sequence[float]) -> float | None:
    """Return the longest of the short gaps, where short and long ones are far apart and half at least are short."""
    ordered = sorted(gaps)
    best, found = TUNING.burst_pause, None
    for i in range((len(ordered) - 1) // 2, len(ordered) - 2):
        if ordered[i + 1] >= best * ordered[i]:
            best, found = ordered[i + 1] / ordered[i], ordered[i]
    return found
