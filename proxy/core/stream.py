"""What is known of one stream: the samples of one key from one robot."""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field

from proxy.core.schedule import Schedule
from utility_specs import InformationType


@dataclass(frozen=True, slots=True)
class Generated:
    """The last sample generated. `t_gen` is on our clock [s], `size` in bytes, `scale` its value factor.

    `features` are what is known of its features: nothing of those of other robots' samples.
    """

    t_gen: float
    size: int
    scale: float
    features: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Sent:
    """A sample that was put on the air."""

    t_gen: float
    t_sent: float
    size: int
    scale: float
    features: Mapping[str, float] = field(default_factory=dict)


@dataclass(slots=True)
class Stream:
    """One stream in the shared view. `id` is its number in its robot's digests."""

    id: int
    robot: str
    key: str
    information_type: InformationType
    schedule: Schedule = field(default_factory=Schedule)
    generated: int = 0
    forwarded: int = 0
    last: Generated | None = None
    sent: Sent | None = None
    recent: deque[Sent] = field(default_factory=lambda: deque(maxlen=512))
    matching: bool = False
    touched: float = 0.0
    reached: set[str] = field(default_factory=set)
    """Tags of the robots that were sent a sample."""
    mean_size: float = 0.0
    """Mean size of the samples generated, the recent ones counting more [B]."""
    interval: float = 0.0
    """Mean interval between sends [s]; 0.0 while fewer than two were seen."""

    def note_generated(self, count: int, last: Generated) -> None:
        """Sample number `count` of the stream was generated."""
        if count <= self.generated:
            return
        self.generated = count
        self.schedule.observe(count, last.t_gen)
        self.last = last
        self.mean_size += (last.size - self.mean_size) * (0.1 if self.mean_size else 1.0)

    def note_sent(self, count: int, sent: Sent) -> list[Sent]:
        """The stream's `count`-th send was this one; sends nobody told us of are spread evenly before it.

        Return all that is new, in order.
        """
        missed = count - self.forwarded - 1
        if missed < 0:
            return []
        noted: list[Sent] = []
        self.forwarded = count
        if self.sent is not None and sent.t_sent > self.sent.t_sent:
            gap = (sent.t_sent - self.sent.t_sent) / (missed + 1)
            self.interval = gap if self.interval == 0.0 else 0.8 * self.interval + 0.2 * gap
            for i in range(min(missed, 32), 0, -1):
                noted.append(Sent(sent.t_gen - i * gap, sent.t_sent - i * gap, sent.size, sent.scale))
        noted.append(sent)
        self.recent.extend(noted)
        self.sent = sent
        return noted

    @property
    def newest(self) -> Generated:
        """The last sample generated; a stream is in the view because there was one."""
        if self.last is None:
            raise LookupError(f"nothing was generated of {self.key} yet")
        return self.last

    @property
    def mean_interval(self) -> float:
        """Mean interval between sends, or the period while unknown [s]."""
        return self.interval or self.schedule.period
