"""What is known of another robot."""

from collections import deque
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from proxy.core.protocol.messages import Digest, Echo, State, StreamDigest, StreamState
from proxy.core.protocol.tuning import TUNING
from proxy.core.view.latency import Latency, LatencyFit, middle
from proxy.core.view.loss import Loss
from proxy.core.view.offset import DRIFT, ClockOffset

PENDING = 1024
"""Stream news kept of streams whose key is not known yet."""
MOST_AGE = 10.0
"""A sample that seems to be older than this when it arrives says nothing about the way [s]."""
MOST_PER_BYTE = 0.1
"""No channel takes as long for a byte [s/B]."""
MOST_WAIT = 1.0
"""A sample that seems to have waited longer than this before it was sent was not the last one generated [s]."""
APART = 2.0
"""A timestamp that is further than this from when its sample was sent does not tell of that [s]."""
EARLY = 0.005
"""A sample may seem to arrive so much before it was sent, besides what the clock offset may be wrong by [s]."""
STANDS = 1e-5
"""Timestamps closer together than this come from a clock that stands still [s]."""
UNHEARD = 2.0
"""A step of a wall clock is told this late at most [s]."""
STREAMS = 1024
"""Streams of one peer that samples are counted of."""
RECENT = 64
"""Samples whose timestamps are not read yet."""
READ = 8192.0
"""Timestamps are read to this part of a second, which is coarser than what a wall clock of today tells as a number."""
LOOK = 0.5
"""What samples take is worked out anew this often while they come [s]."""
SET = 5e-4
"""A wall clock that moved by less was not set [s]."""
FADING = 0.9
"""So much is left of the longest time between samples with each that comes sooner."""
WAITS = 5
"""Waits looked back on."""
UNCONFIRMED, RARELY = 10.0, 3.0
"""What samples took is forgotten when none came for so long [s], or so many usual times, though digests do..."""
SHORTER, SPARE = 0.5, 0.05
"""... that take so much less, and this less besides [s]: it was learnt in a queue, which may be why none comes."""


@dataclass(slots=True)
class Incoming:
    """How the samples of one stream of a peer come in."""

    heard: int = 0
    """Samples received."""
    stamp: float = -1.0
    """Timestamp of the last one [s, its robot's wall clock]; -1.0: it had none."""
    at: float = 0.0
    """When it came [s]."""
    size: int = 0
    astray: bool = False
    """Whether its timestamps are of another clock than its robot's."""
    waits: deque[float] = field(default_factory=lambda: deque(maxlen=WAITS))
    """How long samples waited to be sent [s], as far as digests tell."""
    told: tuple[int, int] | None = None
    """Samples sent by the last news of it, and those received then."""


class _Heard(NamedTuple):
    """A sample that came at `at` [s], and should have been sent when its robot's wall clock showed `shown`."""

    at: float
    size: int
    shown: float
    stream: Incoming


class HeardDigest(NamedTuple):
    """A digest: `sent` then on its robot's clock, `received` then on ours [s], when `samples` had been heard of it."""

    sent: float
    received: float
    samples: int

    @property
    def took(self) -> float:
        """How long it was on its way, by two clocks that differ [s]."""
        return self.received - self.sent


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
    version: str = ""
    """Which Sendworthy it runs, as it says."""
    limits: int = 0
    """Tells what limits its specs set; 0: nobody knows."""
    wire: int = 0
    """The version of the protocol that it speaks; 0: nobody knows."""
    plain: bool = False
    """Whether it takes no part: it is a plain Zenoh node to us until it says what we understand."""
    digest: Digest | None = None
    counted: tuple[float, int, int] | None = None
    """When it last told how many messages and bytes it had sent [s], and these; announcements do not."""
    pending: dict[int, StreamDigest] = field(default_factory=dict)
    unnamed: dict[int, tuple[float, tuple[int, int]]] = field(default_factory=dict)
    """Of those, when they were last sent [s], and what that counts as: bytes and copies."""
    wall_offset: float | None = None
    """Its wall clock minus its monotonic clock [s]; None until it said."""
    clock_error: float = 0.0
    """What its wall clock is wrong by at most [s]; 0.0: nobody knows."""
    apart: float | None = None
    """Its wall clock minus ours [s], when that is worth a warning."""
    samples: int = 0
    """Samples heard from it."""
    last_heard: HeardDigest | None = None
    """When its last digest came."""
    quickest: HeardDigest | None = None
    """The digest since the last echo that was on its way for the shortest time: its echo tells most of clocks."""
    echoed: bool = False
    """Whether anybody has echoed a digest of it, so that it knows of one way how long it is."""
    implausible: int = 0
    """Samples of it whose timestamp could not be right."""
    received_of_ours: int = 0
    sent: int = 0
    """Samples handed to the mesh for it."""
    latency_out: Latency | None = None
    """What our samples take to it, as it tells; None while unknown."""
    heard_by: dict[str, Latency] = field(default_factory=dict)
    """What its samples take to other robots, by tag, as these tell."""
    _marks: deque[tuple[float, int]] = field(default_factory=lambda: deque(maxlen=64))
    """Send times of our last digests, and `sent` then."""
    _incoming: dict[str, Incoming] = field(default_factory=dict)
    _recent: deque[_Heard] = field(default_factory=lambda: deque(maxlen=RECENT))
    _samples: LatencyFit = field(default_factory=LatencyFit)
    _digests: LatencyFit = field(default_factory=LatencyFit)
    _out: Loss = field(default_factory=Loss)
    _in: Loss = field(default_factory=Loss)
    _last: tuple[float, int] = (0.0, 0)
    """When the last sample came [s], and its size [B]."""
    _period: float = 0.0
    """The longest time between two that came lately [s]."""
    _usual: Latency | None = None
    _looked: float = 0.0
    _due: int = 0
    _came: int = 0
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
        if len(streams) > TUNING.streams:
            return None
        return replace(self.state, streams=tuple(streams.values()), wall_offset=state.wall_offset, number=state.number)

    @property
    def digest_received(self) -> float:
        """When its last digest came [s]; 0.0 when none did."""
        return 0.0 if self.last_heard is None else self.last_heard.received

    @property
    def latency_in(self) -> Latency | None:
        """What samples of the peer take to us; as long as too few came, its digests; None while unknown."""
        return self._samples.line or self._digests.line

    @property
    def counted_samples(self) -> tuple[int, int]:
        """How many samples went between the peer and us lately, and how many of these got lost."""
        (out, lost_out), (came, lost_in) = self._out.counted, self._in.counted
        return out + came, lost_out + lost_in

    @property
    def loss_out(self) -> float | None:
        """The part of our samples that does not reach the peer; None while unknown."""
        return self._out.share

    @property
    def loss_in(self) -> float | None:
        """The part of the samples sent to us that does not reach us; None while unknown."""
        return self._in.share

    @property
    def line_out(self) -> Latency | None:
        """What our samples take to the peer, else digests; None while unknown."""
        return self.latency_out or self._line_of_digests

    @property
    def line_in(self) -> Latency | None:
        """What samples of the peer take to us, else digests there and back; None while unknown."""
        return self.latency_in or self._line_of_digests

    @property
    def _line_of_digests(self) -> Latency | None:
        """What digests take there and back; None while nobody can say."""
        return Latency(self.offset.latency) if self.offset.known or self.offset.latency else None

    def take_state(self, now: float, state: State) -> None:
        """The peer's state replaces what it said before."""
        self.keys = {stream.id: stream.key for stream in state.streams}
        self.told = {stream.key: stream for stream in state.streams}
        self.subscriptions, self.origins = state.subscriptions, state.origins
        if (self.mode, self.specs) != (state.mode, state.specs):
            self.restart_losses()
        self.mode, self.specs = state.mode, state.specs
        self.transport = state.transport
        self.version, self.limits = state.version, state.limits
        self._take_clock(now, state)
        self.state = state

    def _take_clock(self, now: float, state: State) -> None:
        """What a state tells of the wall clock; of two of one number that differ one is forged: then nobody knows."""
        before = self.wall_offset
        stepped = before is not None and abs(before - state.wall_offset) > SET
        contested = 0 < state.number == self.number and (stepped or state.clock_error != self.clock_error)
        self.clock_error = 0.0 if contested else state.clock_error
        if before is not None and stepped:
            self.offset.unshown()
            self._read(now - UNHEARD)
            self.wall_offset = state.wall_offset
            self._read(now, before)
        self.wall_offset = state.wall_offset

    def postpone(self, news: StreamDigest) -> bool:
        """Keep news of a stream whose key is not known yet; return whether there is room for it."""
        if len(self.pending) >= PENDING and news.id not in self.pending:
            self.evicted += 1
            return False
        self.pending[news.id] = news
        return True

    def heard_digest(self, now: float, digest: Digest) -> None:
        """A digest of the peer arrived."""
        self.digest = digest
        self.last_heard = heard = HeardDigest(digest.sent, now, self.samples)
        if self.quickest is None or heard.took <= self.quickest.took + DRIFT * (now - self.quickest.received):
            self.quickest = heard
        if not digest.brief:
            self.counted = now, digest.messages, digest.bytes
        self.offset.heard(digest.sent, now)
        if self.offset.known and now >= self._last[0] + max(UNCONFIRMED, RARELY * self._period):
            self._forget_queue()

    def time_digest(self, now: float, size: int) -> None:
        """The digest that has just arrived, and whose echoes are known, is an example of what messages take."""
        if self.digest is not None and self.offset.known:
            self._digests.observe(now, size, max(0.0, now - self.offset.ours(self.digest.sent)))

    def heard_echo(self, now: float, echo: Echo) -> None:
        """The peer tells what it got of us."""
        if echo.sent > now:
            return  # of a digest that we have not sent
        self.offset.echoed(echo.sent, echo.received)
        self.received_of_ours, self.latency_out = echo.samples, latency_of(echo)
        sent = next((count for at, count in self._marks if abs(at - echo.sent) < STANDS), None)
        if sent is not None:
            self._out.read(sent, echo.samples)

    def sent_digest(self, at: float) -> None:
        """We send a digest: its echo will say what had arrived of what was sent by now."""
        self._marks.append((at, self.sent))

    def heard_sample(self, now: float, key: str, size: int, stamp: float | None) -> float | None:
        """A sample of the peer arrived; `stamp` is on its wall clock [s].

        Return when it was generated, on our clock [s], by what samples take and how long they wait; None while that is
        not known. Its timestamp serves to find what samples take, once it is sure that the clock was not set meanwhile.
        """
        self.samples += 1
        if self._last[1]:
            self._period = max(now - self._last[0], FADING * self._period)
        self._last = now, size
        incoming = self._of(key)
        incoming.heard += 1
        incoming.at, incoming.size = now, size
        wait = middle(incoming.waits) if incoming.waits else 0.0
        before, incoming.stamp = incoming.stamp, -1.0 if stamp is None else stamp
        if stamp is not None and self.wall_offset is not None and self.offset.known:
            if abs(stamp - before) < STANDS:
                self.implausible += 1
            else:
                if len(self._recent) == RECENT:
                    self._read(self._recent[0].at)
                self._recent.append(_Heard(now, size, stamp + wait, incoming))
        self._read(now - UNHEARD)
        line = self._usually(now)
        return None if line is None else now - line.of(size) - wait

    def heard_news(self, key: str, news: StreamDigest, *, counts: bool) -> None:
        """The peer tells of a stream; it `counts` where we get every sample, and have got what it says was sent."""
        incoming = self._of(key)
        before, incoming.told = incoming.told, (news.forwarded, incoming.heard) if counts else None
        if before is not None and counts and news.forwarded >= before[0]:
            if not self._in.begun:
                self._in.read(self._due, self._came)
            self._due += news.forwarded - before[0]
            self._came += incoming.heard - before[1]
            self._in.read(self._due, self._came)
            if news.forwarded - before[0] == incoming.heard - before[1] > 0:
                self._compare(incoming, news)
        wait = news.t_forwarded - news.t_generated
        if (before is None or news.forwarded > before[0]) and 0.0 <= wait < max(MOST_WAIT, news.period):
            incoming.waits.append(wait)

    def restart_losses(self) -> None:
        """What is sent and what is counted there are not the same any more."""
        self._out.restart()
        self._in.restart()
        for incoming in self._incoming.values():
            incoming.told = None

    def _compare(self, incoming: Incoming, news: StreamDigest) -> None:
        """All that was sent came: so news tells when the last one was sent, whatever an application stamped it with.

        What was learned from timestamps of another clock is forgotten.
        """
        if incoming.stamp < 0.0 or self.wall_offset is None or not self.offset.known:
            return
        incoming.astray = abs(news.t_forwarded - (incoming.stamp - self.wall_offset)) > APART + news.period
        line, took = self._samples.line, incoming.at - self.offset.ours(news.t_forwarded)
        if incoming.astray and line is not None and line.of(incoming.size) > took + APART:
            self._samples = LatencyFit()

    def _forget_queue(self) -> None:
        """Samples that seem to come too late to be worth anything are not sent, so nobody would learn better."""
        line = self._samples.line
        if line is not None and self.offset.latency < SHORTER * line.of(self._last[1]) - SPARE:
            self._samples = LatencyFit()
            self._recent.clear()

    def _read(self, until: float, *others: float) -> None:
        """Read the timestamps of samples that came until then: had the wall clock been set, that was told by now.

        `others` are offsets that it may have had, too: the likeliest reading counts.
        """
        while self._recent and self._recent[0].at <= until:
            heard = self._recent.popleft()
            took = None if heard.stream.astray else self._took(heard, self.wall_offset)
            for offset in () if heard.stream.astray else others:
                took = self._likelier(heard, self._took(heard, offset), took)
            if took is None:
                self.implausible += 1
            else:
                self._samples.observe(heard.at, heard.size, took)

    def _took(self, heard: _Heard, wall_offset: float | None) -> float | None:
        """The time from sending to receipt of a sample [s]; None when it cannot be right."""
        if wall_offset is None:
            return None
        took = round(READ * (heard.at - self.offset.ours(heard.shown - wall_offset))) / READ
        if took >= 0.0:
            return took if took < MOST_AGE else None
        return 0.0 if took >= -EARLY - self.offset.uncertainty(heard.at) else None

    def _likelier(self, heard: _Heard, one: float | None, other: float | None) -> float | None:
        """Of two times that a sample may have taken the one that is nearer to what they usually take [s]."""
        if one is None or other is None:
            return other if one is None else one
        line = self._usually(heard.at)
        usual = line.of(heard.size) if line else 0.0
        return one if abs(one - usual) <= abs(other - usual) else other

    def _usually(self, now: float) -> Latency | None:
        """What samples take to us, looked at anew now and then."""
        if self._usual is None or now >= self._looked + LOOK:
            self._usual, self._looked = self.line_in, now
        return self._usual

    def _of(self, key: str) -> Incoming:
        """Return how a stream comes in; if there are too many, the one not heard of for longest is forgotten."""
        found = self._incoming.pop(key, None) or Incoming()
        if len(self._incoming) >= STREAMS:
            del self._incoming[next(iter(self._incoming))]
            self.evicted += 1
        self._incoming[key] = found
        return found


def latency_of(echo: Echo) -> Latency | None:
    """Return what an echo tells of the way; None when its sender does not know, or tells what cannot be."""
    possible = 0.0 <= echo.latency < MOST_AGE and 0.0 <= echo.per_byte < MOST_PER_BYTE
    return Latency(echo.latency, echo.per_byte) if possible and (echo.latency or echo.per_byte) else None
