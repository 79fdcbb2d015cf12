"""Forecasts of a mission's next messages from what a team would know: periods and means (§4.2).

Of every stream the mean period, the mean slope and the rest of what its messages have in common are known, not when
it began: its phase is the mean of what it generated so far. Single messages deviate from both.
"""

from dataclasses import dataclass, field, replace
from statistics import fmean, pstdev

from planner import Linear, Message, Problem
from planner.utility import MessageUtility

LEAST_DELAY = 1e-6
"""A forecast message comes after the current one, by so much at least [s]."""

EARLY = 1.0
"""A message is expected so many standard deviations of its generation time before the mean.

One that comes earlier than planned finds the window still occupied, one that comes later loses next to nothing.
"""


@dataclass(slots=True)
class _Rhythm:
    """When one stream generates: at `period` [s], from a phase that the times seen so far tell."""

    typical: Message
    period: float
    lead: float
    """How much before the mean the next ones are expected [s]."""
    phases: list[float] = field(default_factory=list)
    """When the stream would have begun, by each message seen [s]."""

    def expect(self, now: float, until: float, most: int) -> list[float]:
        """Return at most `most` times in (now, until]; a late message is due at once."""
        start = fmean(self.phases) - self.lead if self.phases else now + (self.period - now) / 2
        number = len(self.phases)
        times = (max(start + self.period * k, now + LEAST_DELAY) for k in range(number, number + most))
        return [t for t in times if t <= until]

    def message(self, t_gen: float) -> Message:
        """Return the message expected at a time."""
        t_sent = t_gen + (self.typical.t_sent - self.typical.t_gen)
        return replace(
            self.typical, t_gen=t_gen, t_sent=t_sent, t_rcv=t_sent + (self.typical.t_rcv - self.typical.t_sent)
        )


class Forecaster:
    """Watches the messages of a mission go by and expects the next ones."""

    def __init__(self, mission: Problem) -> None:
        self._mission = mission
        rhythms = ((stream, _rhythm(mission, stream)) for stream in range(len(mission.streams)))
        self._rhythms = {stream: rhythm for stream, rhythm in rhythms if rhythm is not None}
        self._seen = 0

    def expect(self, index: int, count: int) -> list[Message]:
        """Return the at most `count` messages expected after message `index` of the mission, in order."""
        for message in self._mission.messages[self._seen : index + 1]:
            rhythm = self._rhythms.get(message.stream)
            if rhythm is not None:
                rhythm.phases.append(message.t_gen - rhythm.period * len(rhythm.phases))
        self._seen = max(self._seen, index + 1)
        now = self._mission.messages[index].t_gen
        robots = [stream.robot for stream in self._mission.streams]
        due = sorted(
            (t, robots[stream], stream)
            for stream, rhythm in self._rhythms.items()
            for t in rhythm.expect(now, self._mission.t_end, count)
        )
        return [self._rhythms[stream].message(t) for t, _, stream in due[:count]]


def _rhythm(mission: Problem, stream: int) -> _Rhythm | None:
    """Return the rhythm of a stream; None for one that has no two messages in the mission."""
    messages = [m for m in mission.messages if m.stream == stream]
    if len(messages) < 2:
        return None
    period = (messages[-1].t_gen - messages[0].t_gen) / (len(messages) - 1)
    jitter = pstdev(m.t_gen - period * k for k, m in enumerate(messages))
    typical = replace(messages[0], utility=_mean_utility([m.utility for m in messages]))
    return _Rhythm(typical, period, EARLY * jitter)


def _mean_utility(utilities: list[MessageUtility]) -> MessageUtility:
    """Return the linear utility of mean slope; of other kinds the first."""
    linear = [utility for utility in utilities if isinstance(utility, Linear)]
    if len(linear) < len(utilities):
        return utilities[0]
    return Linear(fmean(u.u0 for u in linear), fmean(u.slope for u in linear))
