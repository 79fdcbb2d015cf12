"""The shared view: every stream, every peer, and what the channel carries, as far as this robot knows."""

from collections.abc import Iterator
from functools import lru_cache

import zenoh

from planner import Aggregation
from proxy.core.events import SampleHeard
from proxy.core.latency import Latency
from proxy.core.peer import Peer, latency_of
from proxy.core.settings import CoreSettings
from proxy.core.stream import Generated, Sent, Stream
from proxy.core.transport import is_broadcast
from proxy.core.ways import Audiences, latency
from proxy.core.wire import Digest, Echo, State, StreamDigest, tag
from utility_specs import Specs

DIGEST = 150
"""A digest is about so large on the way [B]."""
LEAST_LATENCY = 1e-6
"""What is told of a way takes at least this long [s]: nothing at all stands for nothing known."""
STALE = 10.0
"""Streams without news for this long, or for this many periods, take no part in plans [s]."""


@lru_cache(maxsize=65_536)
def intersects(expression: str, key: str) -> bool:
    """Whether a subscription's key expression matches the key; an invalid one matches nothing."""
    try:
        return bool(zenoh.KeyExpr(expression).intersects(zenoh.KeyExpr(key)))
    except zenoh.ZError:
        return False


class SharedView:
    """Everything overheard, bounded: `evicted` counts what had to be forgotten."""

    def __init__(self, settings: CoreSettings, specs: Specs) -> None:
        self.settings = settings
        self.specs = specs
        self.peers: dict[str, Peer] = {}
        """The other robots, by tag."""
        self.wall_offset = settings.wall_offset
        """Our wall clock minus our monotonic clock [s]."""
        self.audiences = Audiences(self)
        self.interest: tuple[str, ...] = ()
        self.origins: dict[str, None] = {settings.zid: None}
        self.messages = 0
        self.bytes = 0
        self.evicted = 0
        self._streams: dict[tuple[str, str], Stream] = {}
        self._wanting: dict[tuple[str, str], tuple[str, ...]] = {}
        self._broadcasting: set[str] = set()
        self._note_broadcasting()
        self._ids = 0

    def set_interest(self, keys: tuple[str, ...]) -> None:
        """The apps of this robot now subscribe to these key expressions."""
        self.interest = keys
        self._wanting.clear()

    def aired(self, messages: int, size: int) -> None:
        """So many messages of so many bytes in all, copies counted, go on the air."""
        self.messages += messages
        self.bytes += size

    def streams(self) -> Iterator[Stream]:
        """All streams, own ones and others'."""
        return iter(self._streams.values())

    def own(self) -> Iterator[Stream]:
        """The streams of this robot."""
        return (s for s in self._streams.values() if s.robot == self.settings.robot)

    def stream(self, now: float, robot: str, key: str) -> Stream | None:
        """The stream of a robot and key, made when new; None when no spec covers the key."""
        found = self._streams.get((robot, key))
        if found is None:
            information_type = self.specs.match(key)
            if information_type is None:
                return None
            self._ids += 1
            found = self._streams[robot, key] = Stream(self._ids, robot, key, information_type)
            if len(self._streams) > self.settings.streams:
                oldest = min(self._streams.values(), key=lambda s: (s is found, s.touched))
                del self._streams[oldest.robot, oldest.key]
                self._wanting.pop((oldest.robot, oldest.key), None)
                self.evicted += 1
        found.touched = now
        return found

    def set_specs(self, specs: Specs) -> None:
        """Swap the specs whole: streams keep what was observed and get the type that covers them now."""
        self.specs = specs
        for place, stream in list(self._streams.items()):
            information_type = specs.match(stream.key)
            if information_type is None:
                del self._streams[place]
            else:
                stream.information_type = information_type

    def wanting(self, stream: Stream) -> tuple[str, ...]:
        """Tags of the robots that want the stream; a nameless one when Zenoh knows of somebody whom no state names."""
        place = (stream.robot, stream.key)
        if place not in self._wanting:
            self._wanting[place] = self._find_wanting(stream)
        return self._wanting[place] or ("",) * stream.matching

    def receivers(self, stream: Stream) -> int:
        """How many robots want the stream."""
        return len(self.wanting(stream))

    def gaining(self, stream: Stream) -> tuple[str, ...]:
        """Tags of those to which more of the stream is worth anything: of `once`, who were not sent any of it yet."""
        wanting = self.wanting(stream)
        if stream.information_type.aggregation is not Aggregation.ONCE:
            return wanting
        return tuple(name for name in wanting if name not in stream.reached)

    def note_sent(self, stream: Stream, count: int, sent: Sent) -> None:
        """The `count`-th sample sent of a stream was this one."""
        stream.note_sent(count, sent)
        stream.reached.update(self.wanting(stream))

    def copies(self, stream: Stream) -> int:
        """Transmissions that one sample costs: one per robot that wants it, and when relayed one more to the router.

        In broadcast it is one for all.
        """
        if stream.robot in self._broadcasting:
            return 1
        if not self.settings.relayed:
            return max(1, self.receivers(stream))
        return 1 + sum(name != "" for name in self.wanting(stream))

    def competes(self, now: float, stream: Stream) -> bool:
        """Whether more of the stream is worth anything to somebody, and more is to be expected."""
        return stream.last is not None and self._active(now, stream) and bool(self.gaining(stream))

    def tags(self) -> dict[str, str]:
        """The tags of all robots by their names, our own included."""
        return {peer.robot: name for name, peer in self.peers.items()} | {self.settings.robot: tag(self.settings.zid)}

    def latency(self, robot: str, size: float = 0.0) -> float:
        """Mean time from sending to receipt of a robot's samples of `size` [s]; 0.0 when nothing is known."""
        return latency(self, robot, size)

    def peer_called(self, robot: str) -> Peer | None:
        """The peer of a name; of one that has restarted its new self, when the old one has not left yet."""
        return next((peer for peer in reversed(self.peers.values()) if peer.robot == robot), None)

    def robot_of(self, origin: str | None) -> str:
        """The robot whose app side an origin entered; an unknown origin is a provisional plain node."""
        if origin is None or origin in self.origins:
            return self.settings.robot
        for peer in self.peers.values():
            if origin == peer.zid or origin in peer.origins:
                return peer.robot
        return f"?{origin}"

    def claim(self, origin: str | None) -> bool:
        """A sample with this origin entered our app side; True when that made it newly ours."""
        if origin is None or origin in self.origins or not self.robot_of(origin).startswith("?"):
            return False
        if len(self.origins) >= 256:
            self.evicted += 1
            self.origins.pop(next(o for o in self.origins if o != self.settings.zid))
        self.origins[origin] = None
        return True

    def heard_sample(self, event: SampleHeard) -> None:
        """A sample of another robot arrived from the mesh."""
        now, robot = event.now, self.robot_of(event.origin)
        peer = self.peer_called(robot)
        if peer is not None and peer.digest is not None:
            peer.heard_sample(now, event.key, event.size, event.stamp)
        elif robot.startswith("?") and (stream := self.stream(now, robot, event.key)) is not None:
            features = event.features or {}
            scale = stream.information_type.scale(features)
            stream.note_generated(stream.generated + 1, Generated(now, event.size, scale, features))
            self.note_sent(stream, stream.forwarded + 1, Sent(now, now, event.size, scale, features))

    def heard_digest(self, now: float, digest: Digest) -> bool:
        """A peer's digest arrived; False when it is unknown, old or our own."""
        peer = self.peers.get(digest.tag)
        if peer is None or (peer.digest is not None and digest.sent <= peer.digest.sent):
            return False
        if peer.specs != self.specs.generation:
            peer.restart_losses()  # it may not count what we count
        peer.heard_digest(now, digest)
        for echo in digest.echoes:
            self._heard_echo(now, peer, echo)
        if not is_broadcast(peer.transport):
            peer.time_digest(now, DIGEST)
        for news in digest.streams:
            self._take(now, peer, news)
        return True

    def heard_state(self, now: float, state: State) -> None:
        """A peer's state arrived; news of its streams that waited for their keys is taken in."""
        peer = self.peers.get(tag(state.zid))
        if peer is None:
            return
        peer.take_state(now, state)
        self._note_broadcasting()
        self._wanting.clear()
        for number in [n for n in peer.pending if n in peer.keys]:
            self._take(now, peer, peer.pending.pop(number))

    def add_peer(self, now: float, robot: str, zid: str) -> bool:
        """A robot's presence token appeared; False when we know it already."""
        if tag(zid) in self.peers:
            return False
        self.peers[tag(zid)] = Peer(robot, zid, now)
        self._wanting.clear()
        return True

    def gone(self, zid: str) -> None:
        """A robot left: it and its streams take no part in plans any more."""
        peer = self.peers.pop(tag(zid), None)
        self._wanting.clear()
        self._note_broadcasting()
        for stream in self.streams():
            stream.reached.discard(tag(zid))
        for other in self.peers.values():
            other.hears.pop(tag(zid), None)
        if peer is not None and all(other.robot != peer.robot for other in self.peers.values()):
            for place in [p for p in self._streams if p[0] == peer.robot]:
                del self._streams[place]

    def echoes(self) -> tuple[Echo, ...]:
        """What we tell every peer of its last digest and of its samples."""
        return tuple(_echo(name, peer, peer.digest) for name, peer in self.peers.items() if peer.digest is not None)

    def sent_digest(self, at: float) -> None:
        """A digest of ours goes out."""
        for peer in self.peers.values():
            peer.sent_digest(at)

    def restart_losses(self) -> None:
        """From now on other samples are counted than before."""
        for peer in self.peers.values():
            peer.restart_losses()

    def handed(self, key: str) -> None:
        """A covered sample of ours was handed to the mesh; in broadcast it gets to all, else to those that want it."""
        stream = self._streams.get((self.settings.robot, key))
        everybody = self.settings.robot in self._broadcasting
        reached = self.peers if everybody else () if stream is None else self.wanting(stream)
        for name in reached:
            if name in self.peers:
                self.peers[name].sent += 1

    def _heard_echo(self, now: float, peer: Peer, echo: Echo) -> None:
        if echo.peer == tag(self.settings.zid):
            peer.heard_echo(now, echo)
        elif echo.peer in self.peers and (line := latency_of(echo)) is not None:
            peer.hears[echo.peer] = line

    def _find_wanting(self, stream: Stream) -> tuple[str, ...]:
        """Return the robots whose apps subscribe to the stream, this robot included, by their tags."""
        robots = [(name, peer.robot, peer.subscriptions) for name, peer in self.peers.items()]
        robots.append((tag(self.settings.zid), self.settings.robot, self.interest))
        return tuple(
            name
            for name, robot, expressions in robots
            if robot != stream.robot and any(intersects(expression, stream.key) for expression in expressions)
        )

    def _note_broadcasting(self) -> None:
        transports = {peer.robot: peer.transport for peer in self.peers.values()}
        transports[self.settings.robot] = self.settings.transport
        self._broadcasting = {robot for robot, transport in transports.items() if is_broadcast(transport)}

    def _take(self, now: float, peer: Peer, news: StreamDigest) -> None:
        key = peer.keys.get(news.id)
        if key is None:
            peer.postpone(news)
            return
        stream = self.stream(now, peer.robot, key)
        if stream is None:
            return
        wanted = peer.robot in self._broadcasting or tag(self.settings.zid) in self.wanting(stream)
        peer.heard_news(key, news, wanted=wanted)
        stream.schedule.assume(peer.periods.get(key, 0.0))
        t_gen = peer.offset.ours(news.t_generated)
        stream.note_generated(news.generated, Generated(t_gen, news.size, news.scale))
        if news.forwarded > stream.forwarded:
            t_sent = peer.offset.ours(news.t_forwarded)
            self.note_sent(stream, news.forwarded, Sent(t_sent, t_sent, news.size, news.scale))

    def _active(self, now: float, stream: Stream) -> bool:
        """Whether more samples are to be expected of the stream."""
        last = stream.schedule.last
        return last is not None and now - last < max(STALE, 5.0 * stream.schedule.period)


def _echo(name: str, peer: Peer, digest: Digest) -> Echo:
    line = peer.latency_in
    told = Latency(0.0) if line is None else Latency(max(line.fixed, LEAST_LATENCY), line.per_byte)
    return Echo(name, digest.sent, peer.digest_received, peer.samples_then, told.fixed, told.per_byte)
