"""The rhythm of a stream as its robot, which sees every sample, tells it: five bytes of a digest."""

from collections.abc import Callable

from proxy.core.forecast.rhythm import Rhythm
from proxy.core.forecast.tuning import TUNING
from proxy.core.protocol.fixed import rounded
from proxy.core.protocol.messages import PHASES, StreamDigest


def encoded(rhythm: Rhythm | None, number: int, t: float) -> tuple[float, int, int]:
    """Return period, lateness of sample `number` of time `t`, and jitter, as a digest has them."""
    if rhythm is None or rhythm.period < TUNING.least_period:
        return 0.0, 0, 0
    part = rhythm.period / PHASES
    return rounded(rhythm.period), round((t - rhythm.due(number)) / part), round(rhythm.jitter / part)


def decoded(news: StreamDigest, ours: Callable[[float], float]) -> Rhythm | None:
    """Return the rhythm that news tell of, on `ours` clock; None where the stream has none."""
    if news.period < TUNING.least_period:
        return None
    part = news.period / PHASES
    known = min(max(news.generated, TUNING.fewest), TUNING.memory)
    return Rhythm(news.period, ours(news.t_generated) - news.late * part, news.generated, news.jitter * part, known)
