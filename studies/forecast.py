"""Forecasts of a mission's next messages from what a team would know: periods and means (§4.2).

Of every stream the mean period, the mean slope and use, and how far single messages deviate from period and use are
known, not when it began: its phase is the mean of what it generated so far. The next messages have the scale of the
last one.

One forecast says when and what messages are *expected*. Several *futures* together say how they may deviate: of every
message to come the deviations are spread evenly over the futures (Latin hypercube sampling), so that a handful will do.
"""

from dataclasses import dataclass, field
from statistics import NormalDist, fmean, pstdev

import numpy as np

from planner import Linear, Message, Problem
from planner.utility import Floats, MessageUtility

LEAST_DELAY = 1e-6
"""A forecast message comes after the current one, by so much at least [s]."""

EARLY = 1.0
"""A message is expected so many standard deviations of its generation time before the mean.

One that comes earlier than planned finds the window still occupied, one that comes later loses next to nothing.
"""

STEPS = 1024
"""So finely the deviations are tabulated."""

TURN = 61
"""After so many messages of a stream the futures deal out its deviations in the same order again."""

_DEVIATIONS = np.array([NormalDist().inv_cdf((i + 0.5) / STEPS) for i in range(STEPS)])


@dataclass(slots=True)
class _Rhythm:
    """When one stream generates: at `period` [s], from a phase that the times seen so far tell."""

    typical: Message
    period: float
    jitter: float
    """Standard deviation of a generation time [s]."""
    uses: Floats
    """What messages of the stream use, in ascending order of each constraint, one row a message."""
    phases: list[float] = field(default_factory=list)
    """When the stream would have begun, by each message seen [s]."""
    scale: float | None = None
    """That of the last message seen, which is expected of the next ones."""

    def expect(self, now: float, most: int) -> Floats:
        """Return when the next `most` are expected after now; a late message is due at once."""
        lead = EARLY * self.jitter if self.phases else 0.0
        return np.maximum(self._means(now, most) - lead, now + LEAST_DELAY)

    def sample(self, now: float, most: int, strata: Floats) -> tuple[Floats, Floats]:
        """Return when the next `most` may come and what they may use, by future.

        `strata[f, n]` holds for the n-th message of the stream, modulo their number, the quantiles of its generation
        time and of its use in future f. What has not come yet comes after now.
        """
        chosen = strata[:, (len(self.phases) + np.arange(most)) % strata.shape[1]]
        uses = self.uses[(chosen[..., 1] * len(self.uses)).astype(np.int64)]
        if not self.phases:
            return np.broadcast_to(self.expect(now, most), chosen.shape[:2]), uses
        means = self._means(now, most)
        times = means + self.jitter * _deviations(chosen[..., 0], now - means, self.jitter)
        return np.sort(np.maximum(times, now + LEAST_DELAY), axis=1), uses

    def message(self, t_gen: float, use: tuple[float, ...] | None = None) -> Message:
        """Return the message expected at a time; one of typical use when nothing else is said."""
        m = self.typical
        t_sent = t_gen + (m.t_sent - m.t_gen)
        t_rcv = t_sent + (m.t_rcv - m.t_sent)
        scale = m.scale if self.scale is None else self.scale
        return Message(m.stream, t_gen, t_sent, t_rcv, m.utility, scale, m.use if use is None else use)

    def _means(self, now: float, most: int) -> Floats:
        """Return when the next ones would come without jitter."""
        start = fmean(self.phases) if self.phases else now + (self.period - now) / 2
        return np.asarray(start + self.period * np.arange(len(self.phases), len(self.phases) + most))


def _deviations(quantile: Floats, least: Floats, jitter: float) -> Floats:
    """Return these quantiles of normal deviations that are known to exceed `least / jitter`."""
    below = np.searchsorted(_DEVIATIONS, least / jitter) / STEPS if jitter > 0 else np.zeros(len(least))
    at = ((below + quantile * (1.0 - below)) * STEPS).astype(np.int64)
    return np.asarray(_DEVIATIONS[np.minimum(at, STEPS - 1)])


class Forecaster:
    """Watches the messages of a mission go by and expects the next ones, and `futures` ways how they may come."""

    def __init__(self, mission: Problem, futures: int = 0, seed: int = 0) -> None:
        self._mission = mission
        rhythms = ((stream, _rhythm(mission, stream)) for stream in range(len(mission.streams)))
        self._rhythms = {stream: rhythm for stream, rhythm in rhythms if rhythm is not None}
        self._strata = _strata(len(mission.streams), futures, seed)
        self._seen = 0

    def expect(self, index: int, count: int) -> list[Message]:
        """Return the at most `count` messages expected after message `index` of the mission, in order."""
        now = self._watch(index)
        due = self._first(count, {at: rhythm.expect(now, count) for at, rhythm in self._rhythms.items()})
        return [self._rhythms[stream].message(t) for t, stream, _ in due]

    def sample(self, index: int, count: int) -> list[list[Message]]:
        """Return for every future the at most `count` messages that come after message `index` in it, in order."""
        now = self._watch(index)
        sampled = {at: rhythm.sample(now, count, self._strata[:, at]) for at, rhythm in self._rhythms.items()}
        futures = []
        for future in range(len(self._strata)):
            due = self._first(count, {at: times[future] for at, (times, _) in sampled.items()})
            uses = {at: own[future].tolist() for at, (_, own) in sampled.items()}
            futures.append([self._rhythms[at].message(t, tuple(uses[at][n])) for t, at, n in due])
        return futures

    def _watch(self, index: int) -> float:
        """Take in what was generated up to message `index`; return its time."""
        for message in self._mission.messages[self._seen : index + 1]:
            rhythm = self._rhythms.get(message.stream)
            if rhythm is not None:
                rhythm.phases.append(message.t_gen - rhythm.period * len(rhythm.phases))
                rhythm.scale = message.scale
        self._seen = max(self._seen, index + 1)
        return self._mission.messages[index].t_gen

    def _first(self, count: int, times: dict[int, Floats]) -> list[tuple[float, int, int]]:
        """Return the first `count` times of all streams within the mission, each with its stream and place there."""
        if not times:
            return []
        streams = np.repeat(list(times), [len(own) for own in times.values()])
        places = np.concatenate([np.arange(len(own)) for own in times.values()])
        every = np.concatenate(list(times.values()))
        robots = np.array([stream.robot for stream in self._mission.streams])[streams]
        order = np.lexsort((streams, robots, every))[:count]
        order = order[every[order] <= self._mission.t_end]
        return list(zip(every[order].tolist(), streams[order].tolist(), places[order].tolist(), strict=True))


def _strata(streams: int, futures: int, seed: int) -> Floats:
    """Return by future, stream and message two quantiles in (0, 1), each spread evenly over the futures."""
    order = np.tile(np.arange(futures, dtype=np.float64)[:, None, None, None], (1, streams, TURN, 2))
    return np.asarray((np.random.default_rng(seed).permuted(order, axis=0) + 0.5) / max(futures, 1))


def _rhythm(mission: Problem, stream: int) -> _Rhythm | None:
    """Return the rhythm of a stream; None for one that has no two messages in the mission."""
    messages = [m for m in mission.messages if m.stream == stream]
    if len(messages) < 2:
        return None
    times = np.array([m.t_gen for m in messages])
    period = float(np.polyfit(np.arange(len(times)), times, 1)[0])
    uses = np.sort(np.array([m.use for m in messages]).reshape(len(messages), len(mission.constraints)), axis=0)
    utility = _mean_utility([m.utility for m in messages])
    typical = messages[0]._replace(utility=utility, use=tuple(uses.mean(axis=0).tolist()))
    return _Rhythm(typical, period, pstdev((times - period * np.arange(len(times))).tolist()), uses)


def _mean_utility(utilities: list[MessageUtility]) -> MessageUtility:
    """Return the linear utility of mean slope; of other kinds the first."""
    linear = [utility for utility in utilities if isinstance(utility, Linear)]
    if len(linear) < len(utilities):
        return utilities[0]
    return Linear(fmean(u.u0 for u in linear), fmean(u.slope for u in linear))
