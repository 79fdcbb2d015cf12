"""What daemons tell each other beside the data: digests and states, as frozen data (`*_codec.py` packs them).

Times are on the sender's monotonic clock [s], sizes bytes, counters cumulative, so a lost digest costs nothing.
"""

from dataclasses import dataclass

from proxy.core.model.settings import UNICAST
from proxy.core.protocol.split_report import SplitReport


def tag(zid: str) -> str:
    """The short form of an id, enough to tell the robots of a team apart within a digest."""
    return zid[:8]


@dataclass(frozen=True, slots=True)
class StreamDigest:
    """The news of one stream: `id` is the sender's number for its key (see `State.streams`)."""

    id: int
    generated: int
    forwarded: int
    t_generated: float
    """Generation time of the last generated."""
    t_forwarded: float
    """When the last forwarded was sent (0.0: none yet)."""
    size: int
    """Size of the last generated."""
    scale: float
    """Value of the last generated: weight times the scale expression over its features."""
    features: tuple[float, ...] = ()
    """Its features in the order of its type, where others need them to value it; else nothing."""
    period: float = 0.0
    """The period of its rhythm as its robot finds [s]; 0.0 where it has none."""
    late: int = 0
    """How much later than due the last one was generated, and by how much they are off [`PHASES` of the period]."""
    jitter: int = 0


@dataclass(frozen=True, slots=True)
class Echo:
    """For the four-timestamp clock offset: the last digest heard from `peer` (a tag), and how its samples arrive."""

    peer: str
    sent: float
    """Send time of that digest, on the peer's clock."""
    received: float
    """Its receipt time, on our clock."""
    samples: int
    """Samples received from the peer since we know it."""
    latency: float
    """Time from sending to receipt of an empty sample of the peer [s]; 0.0 when unknown."""
    per_byte: float = 0.0
    """What every byte of a sample of the peer adds to that [s/B]."""


PHASES = 100
"""A period has so many parts where times within it are told."""


@dataclass(frozen=True, slots=True)
class Digest:
    """One robot's news. `tag` is the short form of its id."""

    robot: str
    tag: str
    sent: float
    messages: int = 0
    """Messages put on the air so far, copies counted."""
    bytes: int = 0
    """Bytes put on the air so far, copies counted."""
    streams: tuple[StreamDigest, ...] = ()
    echoes: tuple[Echo, ...] = ()
    state: int = 0
    """Number of the state in force (see `State.number`): who knows another one asks for it."""
    capacity: tuple[float, ...] = ()
    """Of every adaptive limit, in the order of the constraints, the part of its ceiling that the channel bears."""
    brief: bool = False
    """Whether it only announces what was sent, without messages, bytes, `splits` and features; a `size` of 0 then
    stands for that in the state, a negative `scale` for the default of the type."""
    splits: bool = False
    """Whether the sender finds that each robot has to keep to a part of every limit."""
    split: SplitReport | None = None
    """What it says of parts, where it keeps to one."""
    partial: bool = False
    """Whether streams that it leaves out may have news: it tells of parts alone, or there is more than it holds."""

    @property
    def tells_all(self) -> bool:
        """Whether streams that it leaves out are as they were when it was sent."""
        return not (self.brief or self.partial)


@dataclass(frozen=True, slots=True)
class StreamState:
    """What seldom changes of a stream."""

    id: int
    key: str
    information_type: str
    period: float
    """Mean time between samples [s]; 0.0 when not known yet."""
    jitter: float = 0.0
    """Standard deviation of a generation time from its schedule [s]."""
    size: int = 0
    """Typical size [B]."""
    schedule: str = ""
    """How the stream generates, as its robot finds; empty while not known."""


@dataclass(frozen=True, slots=True)
class State:
    """What newcomers need to know of a robot; published when it changes, and answered to queries."""

    robot: str
    zid: str
    mode: str
    specs: str
    """Generation of the utility specs in force."""
    streams: tuple[StreamState, ...] = ()
    subscriptions: tuple[str, ...] = ()
    wall_offset: float = 0.0
    """Its wall clock minus its monotonic clock [s], to read the timestamps of its samples."""
    origins: tuple[str, ...] = ()
    """Ids seen in timestamps of samples that entered on this robot's app side."""
    transport: str = UNICAST
    """How its samples travel."""
    number: int = 0
    """Counts the robot's states."""
    clock_error: float = 0.0
    """What its wall clock is wrong by at most [s]; 0.0: nobody knows. An update leaves it as it was."""
    version: str = ""
    """Which Sendworthy it runs; empty: it does not say."""
    limits: int = 0
    """Tells the limits that its specs set all robots from others; 0: it does not say."""
    since: int = 0
    """0: this is all. Else only what is new of the streams since the state of that number; the rest is as it was."""
    splits: bool = False
    """As in a digest: in unicast what is new of parts goes this way, too."""
    split: SplitReport | None = None
    """What the robot said of parts last, where it said so in a state."""
