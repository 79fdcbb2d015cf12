"""What is known of another robot."""

from dataclasses import dataclass, field, replace

from proxy.core.offset import ClockOffset
from proxy.core.wire import MOST_TOLD, Digest, State, StreamDigest, StreamState

PENDING = 1024
"""Stream news kept of streams whose key is not known yet."""


@dataclass(slots=True)
class Peer:
    """Another robot that runs Sendworthy."""

    robot: str
    """Its name here: no other robot's."""
    zid: str
    since: float
    offset: ClockOffset = field(default_factory=ClockOffset)
    keys: dict[int, str] = field(default_factory=dict)
    told: dict[str, StreamState] = field(default_factory=dict)
    """What its state says of its streams, by key."""
    subscriptions: tuple[str, ...] = ()
    origins: tuple[str, ...] = ()
    mode: str = ""
    specs: str = ""
    transport: str = ""
    digest: Digest | None = None
    digest_received: float = 0.0
    pending: dict[int, StreamDigest] = field(default_factory=dict)
    wall_offset: float = 0.0
    samples: int = 0
    """Samples heard from it."""
    latency_in: float = 0.0
    """Mean time from generation there to receipt here [s]; 0.0 while unknown."""
    latency_out: float = 0.0
    """The same for our samples, as the peer tells it."""
    received_of_ours: int = 0
    name: str = ""
    """Its name as it says, which another robot may have too."""
    state: State | None = None
    """The state in force, whole."""
    evicted: int = 0
    """News that there was no room for."""

    @property
    def number(self) -> int:
        """Number of the state in force; 0 when there is none."""
        return 0 if self.state is None else self.state.number

    def whole(self, state: State) -> State | None:
        """Return the whole state that an update makes of the one in force; None when it is for another one."""
        if not state.since:
            return state
        if self.state is None or self.state.number != state.since:
            return None
        streams = {stream.id: stream for stream in self.state.streams} | {stream.id: stream for stream in state.streams}
        if len(streams) > MOST_TOLD:
            return None
        return replace(self.state, streams=tuple(streams.values()), number=state.number)

    @property
    def latency_to(self) -> float | None:
        """Mean time from generation here to receipt there [s], else that of digests; None while unknown."""
        return self.latency_out or (self.offset.latency if self.offset.known else None)

    def take_state(self, state: State) -> None:
        """The peer's state replaces what it said before."""
        self.state = state
        self.keys = {stream.id: stream.key for stream in state.streams}
        self.told = {stream.key: stream for stream in state.streams}
        self.subscriptions, self.origins = state.subscriptions, state.origins
        self.mode, self.specs, self.wall_offset = state.mode, state.specs, state.wall_offset
        self.transport = state.transport

    def postpone(self, news: StreamDigest) -> None:
        """Keep news of a stream whose key is not known yet."""
        if len(self.pending) < PENDING or news.id in self.pending:
            self.pending[news.id] = news
        else:
            self.evicted += 1

    def note_latency(self, latency: float) -> None:
        """A sample of the peer took this long [s]."""
        self.latency_in = latency if self.latency_in == 0.0 else 0.9 * self.latency_in + 0.1 * latency
