"""The characteristic of a mission (§4.1): what messages are worth that are sent at random.

Of each message that was received it is the utility it gained per second in which it was of use: as long as it was worth
anything and, where the newest message counts, until the next one came; where the best one counts, as long as it was
that.
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from random import Random

import numpy as np

from planner import Aggregation, Message, MessageUtility, Problem
from planner.utility import Floats
from studies.study.errors import StudyError

PROBABILITIES = tuple((i + 1) / 30 for i in range(30))
"""With which messages are sent, in one run each."""
GRID = 1_000
"""Into so many pieces a time is cut in which messages fade or compete."""
SOONEST = 1e-3
"""No message is worthless sooner [s]."""
WORTHLESS = 0.01
"""A message is of no more use when it is worth less than this part of its most."""
LEVELS = ("low", "medium", "high")
"""Thirds of the greatest expected utility."""
BINS = 20


@dataclass(frozen=True, slots=True)
class Characteristic:
    """Expected utilities of messages as parts of the greatest, in ascending order."""

    utilities: Floats

    @classmethod
    def of(cls, gained: Iterable[float]) -> "Characteristic":
        """Normalise what messages gained. Raises StudyError where none gained anything."""
        values = np.sort(np.array(list(gained), dtype=np.float64))
        if not len(values) or values[-1] <= 0.0:
            raise StudyError("no message is worth anything: there is nothing to characterise")
        return cls(values / values[-1])

    @property
    def levels(self) -> dict[str, float]:
        """Which part of messages has low, medium and high utility."""
        thirds = np.minimum((self.utilities * len(LEVELS)).astype(int), len(LEVELS) - 1)
        return {name: float(np.mean(thirds == number)) for number, name in enumerate(LEVELS)}

    def histogram(self, bins: int = BINS) -> Floats:
        """Return which part of messages lies in each of so many equal ranges from 0 to 1."""
        counts, _ = np.histogram(self.utilities, bins, (0.0, 1.0))
        return np.asarray(counts / len(self.utilities))

    def below(self, utility: float) -> float:
        """Return the part of messages that are worth no more than this (the eCDF)."""
        return float(np.searchsorted(self.utilities, utility, "right") / len(self.utilities))

    @property
    def best_half(self) -> float:
        """What the better half of messages is worth as a part of all: 0.5 where all are alike."""
        half = (len(self.utilities) + 1) // 2
        return float(self.utilities[-half:].sum() / self.utilities.sum())


def at_random(problem: Problem, seed: int = 0, probabilities: Sequence[float] = PROBABILITIES) -> Floats:
    """Send the messages of a mission at random, once with each probability; return what those received gained.

    Each arrives at its `t_rcv`. Raises StudyError for aggregations of one's own.
    """
    gained = []
    for number, probability in enumerate(probabilities):
        draw = np.random.default_rng([seed, number])
        kept = np.flatnonzero(draw.random(len(problem.messages)) < probability)
        gained.append(gains(problem, {i: problem.messages[i].t_rcv for i in kept.tolist()}))
    return np.concatenate(gained)


def gains(problem: Problem, times: Mapping[int, float]) -> Floats:
    """Return what the messages gained per second of use that one receiver got at these times, by index [utility].

    Messages of streams that nobody receives are left out. Raises StudyError for aggregations of one's own.
    """
    streams: dict[int, list[Message]] = defaultdict(list)
    for index, t_rcv in times.items():
        message = problem.messages[index]
        if t_rcv < problem.t_end and problem.streams[message.stream].receivers:
            streams[message.stream].append(message._replace(t_rcv=t_rcv))
    found = []
    for number, received in sorted(streams.items()):
        received.sort(key=lambda message: message.t_rcv)
        aggregation = problem.streams[number].aggregation
        if not isinstance(aggregation, Aggregation):
            raise StudyError("a stream has an aggregation of its own: what one of its messages is worth is not defined")
        found.append(_gained(aggregation, received, problem.t_end))
    return np.concatenate(found) if found else np.zeros(0)


def _gained(aggregation: Aggregation, received: list[Message], t_end: float) -> Floats:
    begins = np.array([m.t_rcv for m in received])
    match aggregation:
        case Aggregation.BEST:
            return _best(received, t_end)
        case Aggregation.SUM:
            until = np.full(len(received), t_end)
        case Aggregation.ONCE:
            until = np.append(t_end, begins[1:])
        case Aggregation.MOST_RECENT | Aggregation.CURRENT:
            until = np.append(begins[1:], t_end)
    ends = np.maximum(begins, np.minimum(until, _worthless_from(received, t_end)))
    used = ends - begins
    return np.where(used > 0.0, _areas(received, begins, ends) / np.where(used > 0.0, used, 1.0), 0.0)


def _areas(messages: Sequence[Message], begins: Floats, ends: Floats) -> Floats:
    """Return what each message is worth from one time to another [utility·s]."""
    places: dict[MessageUtility, list[int]] = defaultdict(list)
    for place, message in enumerate(messages):
        places[message.utility].append(place)
    born, scales = np.array([m.t_gen for m in messages]), np.array([m.scale for m in messages])
    area = np.zeros(len(messages))
    for utility, at in places.items():
        area[at] = scales[at] * utility.integral((begins - born)[at], (ends - born)[at])
    return area


def _worthless_from(messages: Sequence[Message], t_end: float) -> Floats:
    """Return from when on each message is worth nothing any more [s]."""
    lives: dict[MessageUtility, float] = {}
    for message in messages:
        if message.utility not in lives:
            lives[message.utility] = _life(message.utility, max(t_end - message.t_gen, SOONEST))
    return np.array([m.t_gen + lives[m.utility] for m in messages])


def _life(utility: MessageUtility, longest: float) -> float:
    """Return the age from which on a message is worth nothing, `longest` at most [s]."""
    ages = np.append(0.0, np.geomspace(SOONEST, max(longest, 2.0 * SOONEST), GRID))
    values = utility.value(ages)
    worth = np.flatnonzero(values > WORTHLESS * values.max(initial=0.0))
    return float(ages[min(worth[-1] + 1, GRID)]) if len(worth) else 0.0


def _best(received: Sequence[Message], t_end: float) -> Floats:
    """Return what each message gains per second while it is the best one."""
    begin = received[0].t_rcv
    edges = np.unique(np.concatenate(([m.t_rcv for m in received], np.linspace(begin, t_end, GRID + 1))))
    most, whose = np.zeros(len(edges) - 1), np.full(len(edges) - 1, -1)
    for place, message in enumerate(received):
        ages = np.maximum(edges - message.t_gen, 0.0)
        area = message.scale * message.utility.integral(ages[:-1], ages[1:])
        better = (edges[:-1] >= message.t_rcv) & (area > most)
        most[better], whose[better] = area[better], place
    ruled = whose >= 0
    gained = np.bincount(whose[ruled], most[ruled], minlength=len(received))
    used = np.bincount(whose[ruled], np.diff(edges)[ruled], minlength=len(received))
    return np.asarray(gained / np.where(used > 0.0, used, 1.0))


def of_runs(gained: Iterable[float], most: int, seed: int = 0) -> list[float]:
    """Return at most so many of what messages gained, drawn at random, with four digits: enough for a distribution."""
    values = list(gained)
    if len(values) > most:
        values = Random(seed).sample(values, most)
    return [float(f"{value:.4g}") for value in values]
