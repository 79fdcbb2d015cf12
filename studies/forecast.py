"""Forecasts of a mission's next messages from what a team could know by then: periods and means so far (§4.2).

A stream is expected once its first message was seen, with the mean period of the others; after its second one with its
own. Nothing is known of a whole mission beforehand but when it ends. Two yardsticks know more: `specs` also the streams
that will be, with the weight, fading and size of each, but not their periods; `hindsight` also the period, the
deviations and the means of the whole mission. `results/foresight.md` says what they would be worth.

One forecast says when and what messages are *expected*. Several *futures* together say how they may deviate: of every
message to come the deviations are spread evenly over the futures (Latin hypercube sampling), so that a handful will do.
"""

from statistics import NormalDist
from typing import Literal, Protocol

import numpy as np

from planner import Message, Problem
from planner.utility import Floats
from studies.hindsight import announced, foreknown
from studies.outlook import Outlook, Watch, interval_between_sends, supposed

Knowledge = Literal["seen", "specs", "hindsight"]
"""What a forecast knows: what was seen so far, or more than that."""

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


class Watched(Protocol):
    """What knows a stream, from what went by or from the start."""

    number: int

    def observe(self, message: Message) -> None:
        """Take in the next message."""

    def outlook(self) -> Outlook:
        """Return what is expected now."""

    def uses(self) -> Floats:
        """Return what messages use, in ascending order of each constraint, one row a message."""


def expected_times(outlook: Outlook, now: float, most: int) -> Floats:
    """Return when the next `most` of a stream are expected after now [s]; a late message is due at once."""
    return np.maximum(outlook.means(now, most) - EARLY * outlook.jitter, now + LEAST_DELAY)


class Forecaster:
    """Watches the messages of a mission go by and expects the next ones, and `futures` ways how they may come."""

    def __init__(self, mission: Problem, futures: int = 0, seed: int = 0, knowledge: Knowledge = "seen") -> None:
        self._mission = mission
        self._grows = knowledge != "hindsight"
        self._streams: dict[int, Watched] = {} if self._grows else dict(foreknown(mission))
        self._announced = announced(mission) if knowledge == "specs" else {}
        self._strata = _strata(len(mission.streams), futures, seed)
        self._seen = 0
        self._outlooks: dict[int, Outlook] = {}

    def expect(self, index: int, count: int) -> list[Message]:
        """Return the at most `count` messages expected after message `index` of the mission, in order."""
        now, outlooks = self._watch(index)
        times = {at: expected_times(outlook, now, count) for at, outlook in outlooks.items()}
        due = first_due(count, times, self._mission)
        return [outlooks[stream].message(t) for t, stream, _ in due]

    def sample(self, index: int, count: int) -> list[list[Message]]:
        """Return for every future the at most `count` messages that come after message `index` in it, in order."""
        now, outlooks = self._watch(index)
        sampled = {at: self._sampled(at, outlook, now, count) for at, outlook in outlooks.items()}
        futures = []
        for future in range(len(self._strata)):
            due = first_due(count, {at: times[future] for at, (times, _) in sampled.items()}, self._mission)
            uses = {at: own[future].tolist() for at, (_, own) in sampled.items()}
            futures.append([outlooks[at].message(t, tuple(uses[at][n])) for t, at, n in due])
        return futures

    def life(self, index: int) -> float:
        """Return the mean time between two sends of a stream, as far as known with message `index` [s]."""
        return interval_between_sends(self._watch(index)[1], self._mission.constraints)

    def _watch(self, index: int) -> tuple[float, dict[int, Outlook]]:
        """Take in what was generated up to message `index`; return its time, and what is expected of the streams."""
        now = self._mission.messages[index].t_gen
        if index < self._seen:
            return now, self._outlooks
        for message in self._mission.messages[self._seen : index + 1]:
            if message.stream not in self._streams and self._grows:
                self._streams[message.stream] = Watch()
            if message.stream in self._streams:
                self._streams[message.stream].observe(message)
        self._seen = index + 1
        outlooks = {stream: watched.outlook() for stream, watched in self._streams.items()}
        self._outlooks = supposed({**self._announced, **outlooks})
        return now, self._outlooks

    def _sampled(self, stream: int, outlook: Outlook, now: float, most: int) -> tuple[Floats, Floats]:
        """Return when the next `most` of a stream may come and what they may use, by future.

        `strata[f, n]` holds for the n-th message of the stream, modulo their number, the quantiles of its generation
        time and of its use in future f. What has not come yet comes after now.
        """
        strata = self._strata[:, stream]
        uses = self._streams[stream].uses() if stream in self._streams else np.array([outlook.typical.use])
        chosen = strata[:, (outlook.number + np.arange(most)) % strata.shape[1]]
        used = uses[(chosen[..., 1] * len(uses)).astype(np.int64)]
        means, jitter = outlook.means(now, most), outlook.jitter
        times = means + jitter * _deviations(chosen[..., 0], now - means, jitter)
        return np.sort(np.maximum(times, now + LEAST_DELAY), axis=1), used


def first_due(count: int, times: dict[int, Floats], problem: Problem) -> list[tuple[float, int, int]]:
    """Return the first `count` times of all streams within a mission, each with its stream and place there."""
    if not times:
        return []
    streams = np.repeat(list(times), [len(own) for own in times.values()])
    places = np.concatenate([np.arange(len(own)) for own in times.values()])
    every = np.concatenate(list(times.values()))
    robots = np.array([stream.robot for stream in problem.streams])[streams]
    order = np.lexsort((streams, robots, every))[:count]
    order = order[every[order] <= problem.t_end]
    return list(zip(every[order].tolist(), streams[order].tolist(), places[order].tolist(), strict=True))


def _deviations(quantile: Floats, least: Floats, jitter: float) -> Floats:
    """Return these quantiles of normal deviations that are known to exceed `least / jitter`."""
    below = np.searchsorted(_DEVIATIONS, least / jitter) / STEPS if jitter > 0 else np.zeros(len(least))
    at = ((below + quantile * (1.0 - below)) * STEPS).astype(np.int64)
    return np.asarray(_DEVIATIONS[np.minimum(at, STEPS - 1)])


def _strata(streams: int, futures: int, seed: int) -> Floats:
    """Return by future, stream and message two quantiles in (0, 1), each spread evenly over the futures."""
    order = np.tile(np.arange(futures, dtype=np.float64)[:, None, None, None], (1, streams, TURN, 2))
    return np.asarray((np.random.default_rng(seed).permuted(order, axis=0) + 0.5) / max(futures, 1))
