"""One central decider that flies a whole mission: it decides every message when it is generated.

It sees what the planner would see: what was sent before, the current message, and the next ones up to its horizon.
These are the true ones, so that what it loses against the offline optimum is lost by the decisions alone, not by
forecasts or a channel; or, with `forecast`, those that a team would expect from the periods and means seen so far.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, fields, replace

from planner import Aggregation, Latest, Message, Problem, Stream
from studies.forecast import Forecaster, Knowledge

Policy = Callable[[Problem], bool]
"""Decides the current message of a window: send it?"""


@dataclass(frozen=True, slots=True)
class Uncertain(Problem):
    """A window with what is expected to come, and beside it `futures`: the same decision as it may turn out."""

    futures: tuple[Problem, ...] = ()


@dataclass(slots=True)
class CentralDecider:
    """Flies one mission with windows of `horizon` open messages.

    With `forecast` and some `futures` every window is an `Uncertain` one of so many sampled futures. What
    the forecast knows besides what was seen so far is a yardstick.
    """

    mission: Problem
    horizon: int
    forecast: bool = False
    futures: int = 0
    knowledge: Knowledge = "seen"
    sends: list[int] = field(default_factory=list)
    """What was sent so far, by index in the mission."""
    _last: dict[int, int] = field(default_factory=dict)
    _facts: dict[int, Message] = field(default_factory=dict)
    _newest: dict[int, Latest] = field(default_factory=dict)
    """By stream of `current`: the newest message generated so far."""
    _seen: int = 0
    _reach: float = 0.0
    _life: float = 0.0
    _forecaster: Forecaster | None = None

    def __post_init__(self) -> None:
        self._reach = longest_window(self.mission)
        self._life = mean_interval(self.mission)
        if self.forecast:
            self._forecaster = Forecaster(self.mission, self.futures, knowledge=self.knowledge)

    def fly(self, policy: Policy) -> tuple[int, ...]:
        """Decide all messages in turn; return the indices of those sent."""
        for index in range(len(self.mission.messages)):
            if policy(self.window(index)):
                self.send(index)
        return tuple(self.sends)

    def send(self, index: int) -> None:
        """Make the message a fact of all later windows."""
        message = self.mission.messages[index]
        self.sends.append(index)
        self._last[message.stream] = index
        self._facts[index] = message._replace(sent=True)

    def window(self, index: int) -> Problem:
        """Build the window that decides message `index`.

        Facts are what a constraint may still count and the last message of each stream. The window ends one mean
        interval between sends of a stream after its last message, so that this one has a life, too.
        """
        still_counted = self.mission.messages[index].t_sent - self._reach
        sent = self.mission.messages
        kept = {i for i in self._facts if sent[i].t_sent >= still_counted} | set(self._last.values())
        self._facts = {i: self._facts[i] for i in sorted(kept)}
        self._watch(index)
        current, count = self.mission.messages[index], self.horizon - 1
        if self._forecaster is None:
            return self._with(index, self.mission.messages[index : index + self.horizon])
        expected = self._with(index, (current, *self._forecaster.expect(index, count)))
        if not self.futures:
            return expected
        futures = (self._with(index, (current, *future)) for future in self._forecaster.sample(index, count))
        return Uncertain(**{f.name: getattr(expected, f.name) for f in fields(expected)}, futures=tuple(futures))

    def _watch(self, index: int) -> None:
        """Take in what was generated before message `index`."""
        for message in self.mission.messages[self._seen : index]:
            if self.mission.streams[message.stream].aggregation is Aggregation.CURRENT:
                self._newest[message.stream] = Latest(message.t_gen, message.scale)
        self._seen = max(self._seen, index)

    def _streams(self) -> tuple[Stream, ...]:
        streams = self.mission.streams
        if not self._newest:
            return streams
        return tuple(s._replace(newest=self._newest.get(at, s.newest)) for at, s in enumerate(streams))

    def _with(self, index: int, ahead: tuple[Message, ...]) -> Problem:
        """Build the window of the message to decide and the next ones, up to the horizon."""
        mission = self.mission
        complete = len(ahead) < self.horizon
        if self._forecaster is None:
            complete, life = complete or index + self.horizon >= len(mission.messages), self._life
        else:
            life = self._forecaster.life(index)
        return replace(
            mission,
            streams=self._streams(),
            messages=(*self._facts.values(), *ahead),
            current=len(self._facts),
            t_end=mission.t_end if complete else min(mission.t_end, ahead[-1].t_gen + life),
            goes_on=not complete,
        )


def longest_window(mission: Problem) -> float:
    """Return how far back any constraint looks, stretched windows of oversized messages included [s]."""
    return max(
        (
            constraint.window * max(1.0, max(m.use[k] for m in mission.messages) / constraint.limit)
            for k, constraint in enumerate(mission.constraints)
            if constraint.limit > 0
        ),
        default=0.0,
    )


def mean_interval(mission: Problem) -> float:
    """Return the mean time between two sends of a stream when the tightest constraint is used up [s]."""
    messages, streams = mission.messages, len(mission.streams)
    generated = (mission.t_end - mission.t_start) * streams / len(messages)
    limited = (
        streams * sum(m.use[k] for m in messages) / len(messages) * constraint.window / constraint.limit
        for k, constraint in enumerate(mission.constraints)
        if constraint.limit > 0
    )
    return max([generated, *limited])
