"""What is known of another robot."""

import math
from collections import deque
from collections.abc import Container, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from proxy.core.protocol.messages import Digest, State, StreamDigest, StreamState, tag
from proxy.core.protocol.tuning import TUNING as PROTOCOL
from proxy.core.transit.inbound import Inbound
from proxy.core.transit.latency import Latency
from proxy.core.transit.offset import ClockOffset
from proxy.core.transit.outbound import Outbound
from proxy.core.transit.tuning import TUNING as TRANSIT
from proxy.core.view.stream import Stream
from proxy.core.view.tuning import TUNING

Amount = tuple[int, int]
"""The size of a sample [B], and in how many copies it goes on the air."""
Entry = tuple[float, Amount, str, bool]
"""When something was sent [s], how much, by which robot, and whether that decided on it, under the limits."""


class PendingNews:
    """The last news of each such stream of one robot; `evicted` counts those that had to make room for others."""

    def __init__(self) -> None:
        self._news: dict[int, StreamDigest] = {}
        self._counted: dict[int, Entry] = {}
        """What was last sent of them, as the traffic log counts it."""
        self._forgotten = -1
        """The greatest number of a stream whose news had to make room: a robot's numbers only grow."""
        self.evicted = 0

    def __len__(self) -> int:
        return len(self._news)

    def keep(self, news: StreamDigest) -> bool:
        """Keep news, of too many streams the latest; return whether it surely tells of another sample that was sent."""
        earlier = self._news.pop(news.id, None)
        forgotten = earlier is None and news.id <= self._forgotten
        if earlier is None and len(self._news) >= TUNING.pending_news:
            oldest = next(iter(self._news))
            del self._news[oldest]
            self._counted.pop(oldest, None)
            self._forgotten = max(self._forgotten, oldest)
            self.evicted += 1
        self._news[news.id] = news
        return not forgotten and news.forwarded > (0 if earlier is None else earlier.forwarded)

    def count(self, number: int, entry: Entry) -> None:
        """What was sent of the stream with this number counts as this."""
        self._counted[number] = entry

    def named(self, numbers: Container[int]) -> list[tuple[StreamDigest, Entry | None]]:
        """Return the news of those streams whose keys are known now, each with what it counted as."""
        found = [number for number in self._news if number in numbers]
        return [(self._news.pop(number), self._counted.pop(number, None)) for number in found]


class HeardDigest(NamedTuple):
    """A digest: `sent` then on its robot's clock, `received` then on ours [s], when `samples` had been heard of it."""

    sent: float
    received: float
    samples: int

    @property
    def took(self) -> float:
        """How long it was on its way, by two clocks that differ [s]."""
        return self.received - self.sent


_NOTHING = State("", "", "", "", transport="")


@dataclass(slots=True)
class Peer:
    """Another robot that runs Sendworthy."""

    robot: str
    """Its name here: no other robot's."""
    zid: str
    since: float
    name: str = ""
    """Its name as it says, which another robot may have too."""
    state: State = _NOTHING
    """The state in force, whole; as long as none has come one that says nothing."""
    keys: dict[int, str] = field(default_factory=dict)
    told: dict[str, StreamState] = field(default_factory=dict)
    """What its state says of its streams, by key."""
    clock_error: float = 0.0
    """What its wall clock is wrong by at most [s]; 0.0: nobody knows."""
    wire: int = 0
    """The version of the protocol that it speaks; 0: nobody knows."""
    plain: bool = False
    """Whether it takes no part: it is a plain Zenoh node to us until it says what we understand."""
    digest: Digest | None = None
    """The last digest, which the next one has to follow."""
    last_heard: HeardDigest | None = None
    """When its last digest came."""
    quickest: HeardDigest | None = None
    """The digest since the last echo that was on its way for the shortest time: its echo tells most of clocks."""
    echoed: bool = False
    """Whether anybody has echoed a digest of it, so that it knows of one way how long it is."""
    overheard: bool = False
    """Whether a sample of it came before any digest."""
    counted: tuple[float, int, int] | None = None
    """When it last told how many messages and bytes it had sent [s], and these; announcements do not."""
    pending: PendingNews = field(default_factory=PendingNews)
    heard_by: dict[str, Latency] = field(default_factory=dict)
    """What its samples take to other robots, by tag, as these tell."""
    came: dict[str, tuple[float, int]] = field(default_factory=dict)
    """By tag, when another robot told last how many samples of it came there [s], and how many."""
    offset: ClockOffset = field(default_factory=ClockOffset)
    inbound: Inbound = field(init=False)
    outbound: Outbound = field(init=False)

    def __post_init__(self) -> None:
        self.inbound, self.outbound = Inbound(self.offset), Outbound(self.offset)

    @property
    def tag(self) -> str:
        """The short form of its id."""
        return tag(self.zid)

    @property
    def silent(self) -> bool:
        """Whether nothing but its token is known of it."""
        return not self.announced and self.last_heard is None

    @property
    def announced(self) -> bool:
        """Whether it has told its state."""
        return bool(self.state.zid)

    @property
    def is_namesake(self) -> bool:
        """Whether its name was taken when it came, so that it has another one here."""
        return self.robot != self.name

    @property
    def digest_received(self) -> float:
        """When its last digest came [s]; 0.0 when none did."""
        return 0.0 if self.last_heard is None else self.last_heard.received

    def hear_sample(self) -> None:
        """A sample of it came before any digest."""
        self.overheard = True

    @property
    def evicted(self) -> int:
        """News and streams that there was no room for."""
        return self.inbound.evicted + self.pending.evicted

    def rename(self, robot: str) -> None:
        """It has this name here from now on."""
        self.robot = robot

    def speak(self, version: int) -> None:
        """It speaks this version of the protocol."""
        self.wire = version

    def take_part(self, *, plain: bool) -> None:
        """It is a `plain` node to us, which takes no part, or takes part again."""
        self.plain = plain

    def restart(self) -> None:
        """It may have started anew: the next digest need not follow the last one."""
        self.digest = None

    def note_echo(self, *, ours: bool) -> None:
        """Somebody echoed a digest of it, or we did."""
        self.echoed = True
        if ours:
            self.quickest = None

    def whole(self, state: State) -> State | None:
        """Return the whole state that an update makes of the one in force; None when it is for another one."""
        if not state.since:
            return state
        if not self.announced or self.state.number != state.since:
            return None
        streams = {stream.id: stream for stream in self.state.streams} | {stream.id: stream for stream in state.streams}
        if len(streams) > PROTOCOL.streams:
            return None
        return replace(self.state, streams=tuple(streams.values()), wall_offset=state.wall_offset, number=state.number)

    def take_state(self, now: float, state: State) -> None:
        """The peer's state replaces what it said before."""
        self.keys = {stream.id: stream.key for stream in state.streams}
        self.told = {stream.key: stream for stream in state.streams}
        if (self.state.mode, self.state.specs) != (state.mode, state.specs):
            self.restart_losses()
        self._take_clock(now, state)
        self.state = state

    def _take_clock(self, now: float, state: State) -> None:
        """What a state tells of the wall clock; of two of one number that differ one is forged: then nobody knows."""
        before = self.inbound.wall_offset
        stepped = before is not None and abs(before - state.wall_offset) > TRANSIT.wall_clock_set
        contested = 0 < state.number == self.state.number and (stepped or state.clock_error != self.clock_error)
        self.clock_error = 0.0 if contested else state.clock_error
        if stepped:
            self.offset.unshown()
        self.inbound.set_wall_offset(now, state.wall_offset)

    def heard_digest(self, now: float, digest: Digest) -> None:
        """A digest of the peer arrived."""
        self.digest = digest
        self.last_heard = heard = HeardDigest(digest.sent, now, self.inbound.samples)
        if self.quickest is None or heard.took <= self.quickest.took + TRANSIT.drift * (now - self.quickest.received):
            self.quickest = heard
        if not digest.brief:
            self.counted = now, digest.messages, digest.bytes
        self.offset.heard(digest.sent, now)
        self.inbound.forget_queue(now)

    def restart_losses(self) -> None:
        """Forget the counts of samples, ours and the robot's: from now on other samples are counted."""
        self.outbound.restart_losses()
        self.inbound.restart_losses()


class Staleness:
    """What digests take to come, and until when each robot told of its streams."""

    def __init__(self, peers: Mapping[str, Peer]) -> None:
        self._peers = peers
        self._told_until: dict[str, float] = {}
        """When the last digest of each robot that told of all its streams was sent [s, our clock]; −∞: none did."""
        self._delays: deque[float] = deque(maxlen=TUNING.digest_delays)
        """What the last digests took beyond the quickest of their robots [s]."""
        self.delay = 0.0
        """What all but few digests take beyond their least [s]: they wait for other messages, and for processors."""

    def heard(self, now: float, peer: Peer, digest: Digest) -> None:
        """A digest of a peer came; if it tells of all, streams that it leaves out are silent until it was sent.

        Twelve robots that had told each other only of parts for a minute each found that no other had anything to send,
        and together sent four times the limit for 10 s.
        """
        sent = peer.offset.ours(digest.sent)
        self._delays.append(max(0.0, now - sent - peer.offset.latency))
        self.delay = sorted(self._delays)[int(TUNING.digests_in_time * len(self._delays))]
        until = min(now, sent) if digest.tells_all else -math.inf
        self._told_until[peer.robot] = max(until, self._told_until.get(peer.robot, -math.inf))

    def forget(self, robot: str) -> None:
        """A robot left."""
        self._told_until.pop(robot, None)

    def rename(self, robot: str, name: str) -> None:
        """A robot has another name from now on."""
        if robot in self._told_until:
            self._told_until[name] = self._told_until.pop(robot)

    def told_until(self, robot: str) -> float:
        """Until when a robot told of all its streams [s, our clock]; without end where none tells: all is heard."""
        return self._told_until.get(robot, math.inf)

    def known_until(self, now: float, stream: Stream) -> float:
        """Until when it is known what a stream generated [s, our clock]: others tell of few streams at a time.

        What they do not tell of goes on as it did: else windows of eight robots were over the limit by 5 %, and where
        nobody announced all seemed to send seldom, and announcing to be cheap again.
        """
        return min(now, max(stream.known_until, self.told_until(stream.robot)))

    @property
    def longest_way(self) -> float:
        """What digests take at least from or to any peer, at most [s]."""
        return max([peer.offset.latency for peer in self._peers.values()], default=0.0)

    @property
    def known(self) -> bool:
        """Whether that is known of any way, as a robot has echoed a digest of ours."""
        return any(peer.offset.known for peer in self._peers.values())
