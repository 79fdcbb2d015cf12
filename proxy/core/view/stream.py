"""What is known of one stream: the samples of one key from one robot."""

import math
from bisect import bisect_left
from collections import Counter, deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from statistics import NormalDist
from types import MappingProxyType
from typing import NamedTuple

from planner import Aggregation
from proxy.core.forecast.features import SCALE, Outlook
from proxy.core.forecast.rhythm import Rhythm
from proxy.core.forecast.schedule import Schedule
from proxy.core.protocol.fixed import rounded
from proxy.core.protocol.messages import StreamState
from proxy.core.view.tuning import TUNING
from utility_specs import InformationType
from utility_specs.forecast import FeatureForecast

NORMAL = NormalDist()
Place = tuple[str, str]
"""The robot and key of a stream."""


@dataclass(slots=True)
class Sizes:
    """Of the samples that were generated, the recent ones counting more."""

    mean: float = 0.0
    """[B]"""
    variance: float = 0.0
    """[B²]"""
    announced: int = 0
    """What the stream's robot last announced, so that all robots know the same; 0: nothing yet [B]."""

    @property
    def deviation(self) -> float:
        """The standard deviation [B]."""
        return math.sqrt(self.variance)

    def note(self, size: int) -> None:
        """A sample of so many bytes was generated; older ones fade exponentially."""
        if not self.mean:
            self.mean = float(size)
            return
        off = size - self.mean
        weight = TUNING.newest_size_weight
        self.mean += weight * off
        self.variance = (1.0 - weight) * (self.variance + weight * off * off)

    def announce(self, size: int) -> None:
        """The stream's robot announced this size [B]."""
        self.announced = size

    def likely(self, newest: int) -> int:
        """The size that a sample to come is planned with, after the newest one: a bit less than the mean [B]."""
        if self.variance == 0.0:
            return newest
        likely = self.mean - TUNING.sent_size_deviations * self.deviation
        return round(max(likely, TUNING.least_likely_size * self.mean))

    def smallest(self, part: float) -> int:
        """The mean size of the smallest `part` of the samples [B], if sizes are spread about the mean like a bell."""
        below = NORMAL.pdf(NORMAL.inv_cdf(part)) / part * self.deviation
        return round(max(self.mean - below, TUNING.smallest_size_part * self.mean))


NONE: Mapping[str, float] = MappingProxyType({})


class Generated(NamedTuple):
    """The last sample generated, at `t_gen` on our clock [s], with the `features` that are known of it."""

    t_gen: float
    size: int
    scale: float
    features: Mapping[str, float] = NONE


class Sent(NamedTuple):
    """A sample that was put on the air; `told`: a digest said so before the sample was heard, if ever it is."""

    t_gen: float
    t_sent: float
    size: int
    scale: float
    features: Mapping[str, float] = NONE
    told: bool = False


@dataclass(slots=True, eq=False)
class Stream:
    """One stream in the shared view. `id` is its number in its robot's digests; 0: it has not been told yet."""

    id: int
    robot: str
    key: str
    information_type: InformationType
    schedule: Schedule = field(default_factory=Schedule)
    generated: int = 0
    began: float = 0.0
    """When the first sample was generated that we know of [s]."""
    forwarded: int = 0
    unsent: int = 0
    """The most samples that its robot told of and had not sent, be they dropped or undecided then."""
    last: Generated | None = None
    sent: Sent | None = None
    recent: deque[Sent] = field(default_factory=lambda: deque(maxlen=TUNING.sends_of_stream))
    overheard: bool = False
    """Whether it is known from the air alone: how many were generated and sent its robot has not told yet."""
    matching: bool = False
    known_until: float = -math.inf
    """Until when it is known what was generated, as its robot told or we heard [s]; `Staleness.known_until` says it."""
    fates: Counter[str] = field(default_factory=Counter)
    """What was decided on samples of ours, by reason."""
    reached: set[str] = field(default_factory=set)
    """Tags of the robots that were sent a sample."""
    sizes: Sizes = field(default_factory=Sizes)
    changes: int = 0
    """How often anything was noted of the stream, its schedule or who has it, or it was covered anew."""
    _ahead_since: float = math.inf
    """Since when its robot has told of fewer samples that it sent than we know of [s]."""
    _outlook: Outlook | None = None
    _steady: bool = True
    _expected: dict[int, Generated] = field(default_factory=dict)
    _sent_to: tuple[str, ...] = ()
    _reach: list[float] = field(default_factory=list)

    def cover(self, information_type: InformationType) -> None:
        """This type covers the stream from now on: its schedule and its forecast of features hold."""
        self.changes += 1
        failures, before = information_type.failures, self.information_type
        self.information_type = information_type
        self.schedule.set_rule(information_type.schedule, failures)
        if information_type.forecast.plain:
            self._outlook = None
        elif self._outlook is None or _forecasts(before) != _forecasts(information_type):
            self._outlook = Outlook(information_type.forecast, failures)
            self._steady = True
        self._expected.clear()

    def note_generated(
        self, count: int, last: Generated, *, overheard: bool = False, told: Rhythm | None = None
    ) -> None:
        """Sample number `count` was generated; `overheard`: the first, known from the air; a `told` rhythm holds."""
        if count <= self.generated:
            return
        self.overheard |= overheard
        if not self.generated:
            self.began = last.t_gen - (0.0 if told is None else (count - 1) * told.period)
        self.generated = count
        self.changes += 1
        self.schedule.observe(count, last.t_gen, told)
        self.last = last
        self.sizes.note(last.size)
        if self._outlook is not None:
            self._outlook.note(last.t_gen, last.features or {SCALE: last.scale})
            self._steady = self._outlook.steady
            self._expected.clear()

    def touch(self, until: float, number: int = 0) -> None:
        """It is heard what was generated `until` then [s]; its robot may have told its number."""
        self.changes += until > self.known_until
        self.known_until = max(self.known_until, until)
        self.id = number or self.id

    def rename(self, robot: str) -> None:
        """The stream's robot has another name from now on."""
        self.robot = robot

    def renew(self, last: Generated) -> None:
        """The last sample is this one: read again by the specs in force now, or overheard before news of it."""
        self.last = last
        self.changes += 1
        self._expected.clear()

    def revalue(self) -> None:
        """Value the samples that are known by the specs in force now."""
        scale = self.information_type.scale
        if self.last is not None:
            self.renew(self.last._replace(scale=rounded(scale(self.last.features))))
        if self.sent is not None:
            self.sent = self.sent._replace(scale=rounded(scale(self.sent.features)))
        for k, sent in enumerate(self.recent):
            self.recent[k] = sent._replace(scale=rounded(scale(sent.features)))

    def note_sent(self, count: int, sent: Sent) -> list[Sent]:
        """The stream's `count`-th send was this one, untold ones are spread evenly before it; return all new ones."""
        missed = count - self.forwarded - 1
        if missed < 0:
            return []
        noted: list[Sent] = []
        self.forwarded = count
        self.changes += 1
        if self.sent is not None and sent.t_sent > self.sent.t_sent:
            gap = (sent.t_sent - self.sent.t_sent) / (missed + 1)
            noted += [
                Sent(sent.t_gen - i * gap, sent.t_sent - i * gap, sent.size, sent.scale)
                for i in range(min(missed, TUNING.untold_sends), 0, -1)
            ]
        noted.append(sent)
        self.recent.extend(noted)
        self.sent = sent
        return noted

    def number(self, now: float, count: int, *, heard: bool) -> None:
        """Its robot tells how many samples it sent; the last one may have been `heard` from the air.

        What was sent before we overheard any does not count; where it stays less than we know, its robot knows better.
        """
        self.unsent = max(self.unsent, self.generated - count)
        if self.overheard:
            self.overheard = False
            self.forwarded = max(self.forwarded, count if heard else count - 1)
        self._ahead_since = min(self._ahead_since, now) if count < self.forwarded else math.inf
        if now >= self._ahead_since + TUNING.implausible_for:
            self.forwarded, self._ahead_since = count, math.inf

    def hear_told(self) -> None:
        """The last sample that was sent is heard, of which it was known: the next one that is heard is another one."""
        if self.sent is not None and self.sent.told:
            self.sent = self.sent._replace(told=False)

    def reach(self, names: tuple[str, ...]) -> None:
        """Those robots were sent a sample; mostly they are the same as those before."""
        if names is not self._sent_to:
            self.changes += 1
            self.reached.update(names)
            self._sent_to = names

    def miss(self, names: Iterable[str]) -> None:
        """Those robots were not sent a sample after all."""
        self.changes += 1
        self.reached.difference_update(names)
        self._sent_to = ()

    def match(self, *, matching: bool) -> None:
        """Zenoh tells whether anybody on the mesh wants the stream."""
        self.changes += 1
        self.matching = matching

    def assume(self, told: StreamState) -> None:
        """The stream's robot tells of its schedule and its size."""
        self.sizes.announce(told.size)
        if self.schedule.assume(told.period, told.schedule):
            self.changes += 1

    def expected(self, t_gen: float) -> Generated:
        """What the sample generated at `t_gen` [s] will be like; its own `t_gen` tells of when that was known."""
        if self._outlook is None:
            return self.newest
        if not self._expected:
            period = self.schedule.period
            self._reach = [] if self._steady else [(lead + 0.5) * period for lead in TUNING.leads[:-1]]
        at = bisect_left(self._reach, t_gen - self.newest.t_gen)
        if at not in self._expected:
            self._expected[at] = self._outlined(self._outlook, TUNING.leads[at])
        return self._expected[at]

    @property
    def place(self) -> Place:
        """Its robot and key."""
        return self.robot, self.key

    @property
    def forecasts(self) -> dict[str, str]:
        """The method by which each feature, or the scale, is forecast; nothing where all are as the last one."""
        return self._outlook.chosen if self._outlook is not None else {}

    @property
    def newest(self) -> Generated:
        """The last sample generated; a stream is in the view because there was one."""
        if self.last is None:
            raise LookupError(f"nothing was generated of {self.key} yet")
        return self.last

    @property
    def period(self) -> float:
        """Mean time between samples, long enough to make a rate of [s]."""
        return max(self.schedule.period, TUNING.least_period)

    def _outlined(self, outlook: Outlook, lead: int) -> Generated:
        last = self.newest
        values = outlook.expect(last.t_gen + lead * self.schedule.period)
        if not values:  # nothing was generated since the specs changed
            return last
        if SCALE in values:
            return Generated(last.t_gen, last.size, max(0.0, values[SCALE]))
        return Generated(last.t_gen, last.size, self.information_type.scale(values), values)


def _forecasts(kind: InformationType) -> tuple[FeatureForecast, list[str]]:
    return kind.forecast, [name for name, _ in kind.features]


def usual_scale(stream: Stream) -> float:
    """Return the value of a sample of which nothing more is known, as it travels."""
    kind = stream.information_type
    return rounded(kind.scale(kind.completed({})))


def at_stake(stream: Stream, scale: float) -> float:
    """Return the value factor of what a sample of a `scale` changes: of `current` at least that of the last sent."""
    if stream.sent is None or stream.information_type.aggregation is not Aggregation.CURRENT:
        return scale
    return max(scale, stream.sent.scale)


def excess(stream: Stream) -> float:
    """Return how much more what was sent last shows than the newest sample; 0 unless that is a loss (`current`)."""
    scale = stream.newest.scale
    return at_stake(stream, scale) - scale
