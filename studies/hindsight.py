"""Forecasts that know more than was seen, as yardsticks: what specs may tell of a mission, or all of it afterwards."""

from collections.abc import Iterator
from statistics import fmean, pstdev

import numpy as np

from planner import Message, Problem
from planner.utility import Floats
from proxy.core.forecast.rhythm import Rhythm
from studies.outlook import PRIOR, Outlook, mean_utility


class Hindsight:
    """One stream of which all is known but when it began: the mean of what it generated so far tells that.

    Before its first message it is expected in the middle of its first period, or at once when that is over. The next
    messages have the scale of the last one.
    """

    def __init__(self, typical: Message, period: float, jitter: float, uses: Floats) -> None:
        self.number = 0
        self._typical = typical
        self._period = period
        self._jitter = jitter
        self._uses = uses
        self._phases: list[float] = []

    def observe(self, message: Message) -> None:
        """Take in the next message."""
        self._phases.append(message.t_gen - self._period * self.number)
        self._typical = self._typical._replace(scale=message.scale)
        self.number += 1

    def outlook(self) -> Outlook:
        """Return what is expected now."""
        start = fmean(self._phases) if self._phases else self._period / 2
        # Before the first message its time is a guess, which no deviation makes any better.
        jitter = self._jitter if self._phases else 0.0
        return Outlook(self.number, self._typical, Rhythm(self._period, start, 1, jitter, self.number), self._period)

    def uses(self) -> Floats:
        """Return what messages use, in ascending order of each constraint, one row a message."""
        return self._uses


def foreknown(mission: Problem) -> Iterator[tuple[int, Hindsight]]:
    """Return the streams of a mission that have two messages, with what is known of the whole of it."""
    for stream in range(len(mission.streams)):
        messages = [m for m in mission.messages if m.stream == stream]
        if len(messages) < 2:
            continue
        times = np.array([m.t_gen for m in messages])
        period = float(np.polyfit(np.arange(len(times)), times, 1)[0])
        uses = np.sort(np.array([m.use for m in messages]).reshape(len(messages), len(mission.constraints)), axis=0)
        use = tuple(uses.mean(axis=0).tolist())
        typical = messages[0]._replace(utility=mean_utility([m.utility for m in messages]), use=use)
        yield stream, Hindsight(typical, period, pstdev((times - period * np.arange(len(times))).tolist()), uses)


def announced(mission: Problem) -> dict[int, Outlook]:
    """Return what specs tell of the streams of a mission: what each carries, as its first message has it.

    Nobody knows their periods, so they are expected in the middle of the first `PRIOR` seconds, or at once after that.
    """
    first: dict[int, Message] = {}
    for message in mission.messages:
        first.setdefault(message.stream, message)
    rhythm = Rhythm(PRIOR, PRIOR / 2, 1, 0.0, 1)
    return {stream: Outlook(0, typical, rhythm, PRIOR) for stream, typical in first.items()}
