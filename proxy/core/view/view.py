"""The shared view: every stream, every peer, and what the channel carries, as far as this robot knows."""

import math
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import replace

from planner import Aggregation
from proxy.core.forecast import rhythm_report
from proxy.core.interface.events import SampleHeard
from proxy.core.model.lifetimes import Lifetimes
from proxy.core.model.settings import CoreSettings
from proxy.core.model.transport import is_broadcast
from proxy.core.protocol.messages import Digest, Echo, State, StreamDigest, StreamState, tag
from proxy.core.view.contention import Competition
from proxy.core.view.interest import Interest
from proxy.core.view.latency import Latency
from proxy.core.view.paths import Audiences
from proxy.core.view.peer import SET, HeardDigest, Peer, latency_of
from proxy.core.view.stream import Generated, Sent, Stream, usual_scale
from proxy.core.view.streams import PLAIN, Streams
from utility_specs import Specs

MOST_SENDS = 16_384
"""Sends of other robots looked back on."""
SAME = 1e-3
"""A sample that was generated so much after the last one was sent is another one [s]."""
DIGEST = 150
"""A digest is about so large on the way [B]."""
LEAST_LATENCY = 1e-6
"""What is told of a way takes at least this long [s]: nothing at all stands for nothing known."""
UNTOLD = 2.5e-3
"""Two wall clocks may have moved so much against each other and nobody said so, because it is too little [s]."""
NEW = 10.0
"""In a large team it takes so long until all have told all what they send [s]."""
GREETING = 0.25
"""Who has just been met tells within this time what it sent lately [s]."""
SILENT = 2.0
"""A robot that has sent nothing for so long since we do is not about to [s]."""
MANY, STARTS = 4, 2.0
"""Of more peers than these who was met so shortly ago is not echoed [s]: of nine robots that began at once two took
each other's clocks to be 72 ms apart for 20 s, as all that was echoed was a digest that had waited for 145 ms."""
DELAYS, MOST_OF_THEM = 64, 0.9
"""How long news are delayed is seen by so many of the last digests: this part of them came sooner."""
KEPT = 1.5
"""Others' sends are remembered for so many of the longest windows: who waited for the room that they left may send."""
MOST_PEERS = 256
"""Robots in the view; a robot that said nothing yet has to leave for a new one."""

Amount = tuple[int, int]
"""The size of a sample [B], and in how many copies it goes on the air."""


class SharedView:
    """Everything overheard, bounded: `evicted` counts what had to be forgotten."""

    def __init__(self, settings: CoreSettings, specs: Specs) -> None:
        self.settings = settings
        self._table = Streams(settings, specs)
        self.peers: dict[str, Peer] = {}
        """The other robots, by tag."""
        self.wall_offset = settings.wall_offset
        """Our wall clock minus our monotonic clock [s]."""
        self.clock_error = 0.0
        """What our wall clock is wrong by at most [s]; 0.0: nobody knows."""
        self.audiences = Audiences(self)
        self.competition = Competition(self)
        self.interest: tuple[str, ...] = ()
        self.origins: dict[str, None] = {settings.zid: None}
        self.messages = 0
        self.bytes = 0
        self.largest = 0
        """The largest sample of a stream that we sent since the last digest, all copies of it [B]."""
        self.sends: deque[tuple[float, Amount]] = deque(maxlen=MOST_SENDS)
        """When and how much other robots sent lately."""
        self.talk: deque[tuple[float, Amount]] = deque(maxlen=MOST_SENDS)
        """The same of what robots told each other beyond what limits leave to that."""
        self.lifetimes = Lifetimes()
        self.sends_noted = 0
        """How often that changed."""
        self._tag = tag(settings.zid)
        self._evicted = 0
        self._interest = Interest()
        self._tags = self.tags()
        self._robots: dict[str, str] = {}
        """Robots by the origins they claim."""
        self._broadcasting: set[str] = set()
        self._told_at: dict[str, float] = {}
        """When the last digest of each robot came [s]."""
        self._delays: deque[float] = deque(maxlen=DELAYS)
        """What the last digests took beyond the quickest of their robots [s]."""
        self._untold: set[str] = set()
        """Tags of the robots that did not tell yet what their apps subscribe to."""
        self._met_at = -math.inf
        """When a robot was met last [s]."""
        self._note_broadcasting()

    @property
    def specs(self) -> Specs:
        """The specs in force."""
        return self._table.specs

    @property
    def revision(self) -> int:
        """How often anything changed that concerns more than one stream: which there are, and who wants them."""
        return self._table.revision

    @property
    def evicted(self) -> int:
        """How much had to be forgotten: streams, keys of ours that somebody wants, origins, robots."""
        return self._evicted + self._table.evicted

    def set_interest(self, keys: tuple[str, ...]) -> None:
        """The apps of this robot now subscribe to these key expressions."""
        self.interest = keys
        self._table.revision += 1
        self._interest.set(tag(self.settings.zid), keys)

    def set_matching(self, key: str, *, matching: bool) -> None:
        """Whether anybody on the mesh wants one of our keys; it holds for the stream whenever there is one."""
        self._table.match(key, matching=matching)

    def aired(self, messages: int, size: int) -> None:
        """So many messages of so many bytes in all, copies counted, go on the air."""
        self.messages += messages
        self.bytes += size

    def streams(self) -> Iterator[Stream]:
        """All streams, own ones and others'."""
        return iter(self._table)

    def own(self) -> Iterator[Stream]:
        """The streams of this robot."""
        return self._table.own()

    def stream(self, now: float, robot: str, key: str) -> Stream | None:
        """The stream of a robot and key, made when new; None when no spec plans for the key."""
        return self._table.get(now, robot, key)

    def known(self, robot: str, key: str) -> Stream | None:
        """The stream of a robot and key, if it is in the view."""
        return self._table.known(robot, key)

    def set_specs(self, specs: Specs) -> None:
        """Swap the specs whole: streams keep what was observed and get the type that covers them now."""
        self._table.set_specs(specs)

    def wanting(self, stream: Stream) -> tuple[str, ...]:
        """Tags of the robots that want the stream; a nameless one when Zenoh knows of somebody whom no state names."""
        if stream.wanting_at != self._table.revision:
            stream.wanting = self._interest.wanting(stream.key, self._tags.get(stream.robot, ""))
            stream.wanting_at = self._table.revision
        return stream.wanting or ("",) * stream.matching

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
        noted = stream.note_sent(count, sent)
        stream.reach(self.wanting(stream))
        if stream.robot == self.settings.robot:
            self.largest = max(self.largest, self.copies(stream) * sent.size)
        else:
            amount = sent.size, self.copies(stream)
            self.sends_noted += 1
            self.sends.extend([(each.t_sent, amount) for each in noted])

    def _note_other(self, at: float, size: int) -> tuple[float, Amount]:
        """Something was sent of a stream that we know nothing of; return how that is noted."""
        sent = at, (size, 1)
        self.sends_noted += 1
        self.sends.append(sent)
        return sent

    def _note_unnamed(self, now: float, peer: Peer, news: StreamDigest) -> None:
        """A sample was sent of a stream whose key is not known yet: until it is, as if one robot wanted it.

        In a team that starts, states come seconds after the first frames: eight robots exceeded the limit meanwhile.
        """
        if not news.size or {peer.robot, self.settings.robot} <= self._broadcasting:
            return  # it is not told how large it was, or heard from the air
        peer.unnamed[news.id] = self._note_other(min(peer.offset.ours(news.t_forwarded), now), news.size)

    def note_talk(self, now: float, size: int) -> None:
        """So many bytes of what robots tell each other count against the limits like samples of other robots."""
        self.sends_noted += 1
        self.talk.append((now, (size, 1)))

    def sent_since(self, since: float) -> list[tuple[float, Amount]]:
        """When and how much other robots sent."""
        return [each for each in self.sends if each[0] >= since]

    def overhears(self, stream: Stream) -> bool:
        """Whether we hear what is sent of another robot's stream, but for what is lost."""
        return stream.robot in self._broadcasting and self.settings.robot in self._broadcasting

    def copies(self, stream: Stream) -> int:
        """Transmissions that one sample costs: one per robot that wants it, and when relayed one more to the router.

        In broadcast it is one for all. Robots that did not tell us yet what they want count for our own samples alone:
        who has just come took others' sends for two or three times as many, and sent nothing for a second.
        """
        if stream.robot in self._broadcasting:
            return 1
        receivers = sum(name != "" for name in self.wanting(stream))
        receivers += self.untold if stream.robot == self.settings.robot else 0
        return 1 + receivers if self.settings.relayed else max(1, receivers)

    @property
    def untold(self) -> int:
        """How many robots may want what we send though they did not tell: Zenoh knows sooner than they can."""
        return sum(not self.peers[name].plain for name in self._untold)

    def competes(self, now: float, stream: Stream) -> bool:
        """Whether more of the stream is worth anything to somebody, and more is to be expected.

        How long it is silent only its robot's news tells.
        """
        if stream.last is None or stream.schedule.over(self.told_at(stream.robot, now)):
            return False
        return len(self.gaining(stream)) > 0

    def told_at(self, robot: str, otherwise: float) -> float:
        """When the last digest of a robot was sent [s, our clock]; `otherwise` where none tells of its streams."""
        return self._told_at.get(robot, otherwise)

    def all_told_at(self, robots: Iterable[str], otherwise: float) -> list[float]:
        """Return the same for many robots."""
        told_at = self._told_at.get
        return [told_at(robot, otherwise) for robot in robots]

    def tags(self) -> dict[str, str]:
        """The tags of all robots by their names, our own included."""
        return {peer.robot: name for name, peer in self.peers.items()} | {self.settings.robot: tag(self.settings.zid)}

    @property
    def longest_way(self) -> float:
        """What digests take at least from or to any peer, at most [s]."""
        return max((peer.offset.latency for peer in self.peers.values()), default=0.0)

    @property
    def delay(self) -> float:
        """What digests take beyond that, all but few [s]: they wait for others, and for processors."""
        return sorted(self._delays)[int(MOST_OF_THEM * len(self._delays))] if self._delays else 0.0

    def met_lately(self, now: float) -> list[Peer]:
        """Return the robots of which little may be known yet: they, or our own streams, have just come.

        Teams are often switched on before anything is sent.
        """
        began = self._began()
        return [peer for peer in self.peers.values() if now < max(peer.since, began) + NEW and not peer.plain]

    def greeted_by(self, now: float) -> float:
        """Until when robots that have just been met may still say what they sent lately; −∞ where all have [s]."""
        if now >= self._met_at + GREETING:
            return -math.inf
        new = (p for p in self.peers.values() if p.last_heard is None and not p.plain)
        return max((peer.since + GREETING for peer in new if peer.state is None or peer.told), default=-math.inf)

    def silent(self, peer: Peer) -> bool:
        """Whether a robot has sent nothing although we have for a while: an operator only listens."""
        if peer.counted is None:
            return False
        told_at, messages, _ = peer.counted
        return messages == 0 and told_at >= max(peer.since, self._began()) + SILENT

    def _began(self) -> float:
        return min((stream.began for stream in self.own()), default=-math.inf)

    def peer_called(self, robot: str) -> Peer | None:
        """The peer of a name; of one that has restarted its new self, when the old one has not left yet."""
        return self.peers.get(self._tags.get(robot, ""))

    def robot_of(self, origin: str | None) -> str:
        """The robot whose app side an origin entered; an unknown origin is a provisional plain node."""
        if origin is None or origin in self.origins:
            return self.settings.robot
        return self._robots.get(origin) or f"{PLAIN}{origin}"

    def tag_of(self, origin: str) -> str:
        """The tag of the robot that claims an origin; empty: nobody does. From any thread."""
        return self._tags.get(self._robots.get(origin, ""), "")

    def set_wall_clock(self, offset: float, error: float) -> None:
        """Our wall clock shows so much more than the monotonic one, wrong by `error` at most; 0.0: unknown [s]."""
        if abs(offset - self.wall_offset) > SET:
            for peer in self.peers.values():
                peer.offset.unshown()
        self.wall_offset, self.clock_error = offset, error

    def claim(self, origin: str | None) -> bool:
        """A sample with this origin entered our app side; True when that made it newly ours."""
        if origin is None or origin in self.origins or not self.robot_of(origin).startswith(PLAIN):
            return False
        for stream in self._table.of(f"{PLAIN}{origin}"):
            self._table.forget(stream)
        if len(self.origins) >= 256:
            self._evicted += 1
            self.origins.pop(next(o for o in self.origins if o != self.settings.zid))
        self.origins[origin] = None
        return True

    def heard_sample(self, event: SampleHeard) -> None:
        """A sample of another robot arrived from the mesh."""
        now, robot = event.now, self.robot_of(event.origin)
        peer = self.peer_called(robot)
        if peer is not None and peer.plain:
            peer, robot = None, f"{PLAIN}{event.origin}"
        if peer is not None and peer.digest is not None:
            t_gen = peer.heard_sample(now, event.key, event.size, event.stamp)
            self._overhear(now, t_gen, event, peer)
        elif peer is not None:
            self._note_other(now, event.size)
        elif robot.startswith(PLAIN) and (stream := self._table.get(now, robot, event.key)) is not None:
            features = event.features or {}
            scale = stream.information_type.scale(features)
            generated = Generated(now, event.size, scale, features)
            stream.note_generated(stream.generated + 1, generated, numbered=False)
            self.note_sent(stream, stream.forwarded + 1, Sent(now, now, event.size, scale, features))

    def _overhear(self, now: float, t_gen: float | None, event: SampleHeard, peer: Peer) -> None:
        """A sample of a robot we know was sent: we hear it before its digest tells, or it tells of it already.

        Where its timestamp cannot tell, it was generated when it was sent.
        """
        stream = self._table.known(peer.robot, event.key)
        if stream is None or stream.last is None:
            stream = self._meet(now, t_gen, event, peer)
        if stream is None or stream.last is None:
            self._note_other(now, event.size)
            return
        # No sample is quicker than the quickest digest: rather later than earlier, or its window seems to be over.
        on_air = now - peer.offset.latency + SAME
        t_gen = on_air if t_gen is None else min(t_gen, now)
        if stream.sent is not None and t_gen < stream.sent.t_sent + SAME:
            return
        features = event.features or {}
        scale = stream.information_type.scale(features) if features else stream.last.scale
        t_sent = max(t_gen, on_air)
        self.note_sent(stream, stream.forwarded + 1, Sent(t_gen, t_sent, event.size, scale, features))
        # Its number only the digest tells that follows: a wrong one would spoil the schedule, and hide the right one.
        if t_gen > stream.last.t_gen:
            stream.last = Generated(t_gen, event.size, scale, features or stream.last.features)

    def _meet(self, now: float, t_gen: float | None, event: SampleHeard, peer: Peer) -> Stream | None:
        """A sample of a stream was overheard of which no digest has told yet; None where no spec plans for it.

        In a large team that takes long: of fifty robots that broadcast each knew 100 of 250 streams after 8 s, found
        room for too many samples, and 60 % of the windows were over the limit. With ten robots of equal messages it is
        worth 2 to 4 % of utility.
        """
        stream = self._table.get(now, peer.robot, event.key)
        if stream is None:
            return None
        stream.overheard = True
        if (told := peer.told.get(event.key)) is not None:
            stream.assume(told)
        features, at = event.features or {}, now if t_gen is None else min(t_gen, now)
        last = Generated(at, event.size, stream.information_type.scale(features), features)
        stream.note_generated(1, last, numbered=False)
        return stream

    def heard_digest(self, now: float, digest: Digest) -> bool:
        """A peer's digest arrived; False when it is unknown, old or our own."""
        peer = self.peers.get(digest.tag)
        if peer is None or (peer.digest is not None and digest.sent <= peer.digest.sent):
            return False
        if peer.specs != self.specs.generation:
            peer.restart_losses()  # it may not count what we count
        peer.heard_digest(now, digest)
        self._delays.append(max(0.0, now - peer.offset.ours(digest.sent) - peer.offset.latency))
        if not digest.brief:  # of streams that an announcement leaves out it does not tell that they are silent
            self._told_at[peer.robot] = min(now, peer.offset.ours(digest.sent))
        if digest.state == peer.number:
            self._compare_walls(now, peer)
        for echo in digest.echoes:
            self._heard_echo(now, peer, echo)
        if not is_broadcast(peer.transport):
            peer.time_digest(now, DIGEST)
        for news in digest.streams:
            self._take(now, peer, news)
        return True

    def _compare_walls(self, now: float, peer: Peer) -> None:
        """What the state of a peer says of its wall clock holds now: a bound, where both are known to be right."""
        if self.clock_error and peer.clock_error and peer.wall_offset is not None:
            error = self.clock_error + peer.clock_error + UNTOLD
            peer.offset.shown(now, peer.wall_offset - self.wall_offset, error)

    def heard_state(self, now: float, state: State) -> bool:
        """A peer's state arrived; news of its streams that waited for their keys is taken in.

        False when it is unknown, or the state an update of one that we do not have.
        """
        peer = self.peers.get(tag(state.zid))
        whole = None if peer is None else peer.whole(state)
        if peer is None or whole is None:
            return False
        subscriptions, origins = peer.subscriptions, peer.origins
        self._untold.discard(tag(state.zid))
        peer.take_state(now, whole)
        self._compare_walls(now, peer)
        self._note_broadcasting()
        if peer.subscriptions != subscriptions:
            self._table.revision += 1
            self._interest.set(tag(peer.zid), peer.subscriptions)
        if peer.origins != origins:
            self._note_origins()
        for key, told in peer.told.items():
            if (stream := self._table.known(peer.robot, key)) is not None:
                stream.assume(told)
        for number in [n for n in peer.pending if n in peer.keys]:
            sent = peer.unnamed.pop(number, None)
            if sent is not None and sent in self.sends:
                self.sends.remove(sent)
                self.sends_noted += 1
            self._take(now, peer, peer.pending.pop(number), counts=False)
        return True

    def add_peer(self, now: float, robot: str, zid: str) -> bool:
        """A robot's presence token appeared; False when we know it already, or there are too many.

        Of robots of one name each gets another one here: the later ones with a part of their ids.
        """
        if tag(zid) in self.peers or tag(zid) == tag(self.settings.zid):
            return False
        if len(self.peers) >= MOST_PEERS:
            self._evicted += 1
            silent = next((p for p in self.peers.values() if p.state is None and p.digest is None), None)
            if silent is None:
                return False
            self.gone(silent.zid)
        self.peers[tag(zid)] = Peer(self._free_name(robot, zid), zid, now, name=robot)
        self._untold.add(tag(zid))
        self._met_at = now
        self._presume_ways()
        self._note_origins()
        return True

    def namesakes(self) -> list[Peer]:
        """Return the robots that have another one's name, or ours."""
        return [peer for peer in self.peers.values() if peer.robot != peer.name]

    def gone(self, zid: str) -> None:
        """A robot left: it and its streams take no part in plans any more."""
        peer = self.peers.pop(tag(zid), None)
        if peer is None:
            return
        self._untold.discard(tag(zid))
        self._table.revision += 1
        self._interest.set(tag(zid), ())
        for other in self.peers.values():
            other.heard_by.pop(tag(zid), None)
        for stream in self.streams():
            stream.miss((tag(zid),))
        for stream in self._table.of(peer.robot):
            self._table.forget(stream)
        self._told_at.pop(peer.robot, None)
        heir = next((other for other in self.peers.values() if other.name == peer.robot), None)
        if heir is not None:
            self._rename(heir, heir.name)
        self._note_origins()
        self._note_broadcasting()

    def sweep(self, now: float) -> None:
        """Forget silent streams of plain nodes, and sends no window counts for long; cheap to call at every event."""
        self._table.sweep(now)
        longest = KEPT * max((each.measure.window for each in self.specs.constraints), default=0.0)
        for past in (self.sends, self.talk):
            while past and past[0][0] < now - longest:
                past.popleft()
                self.sends_noted += 1

    def echoes(self, now: float, *, quickest: bool = False) -> tuple[Echo, ...]:
        """What we tell peers of their last digests, or of the `quickest` ones since they were told, and of samples.

        In a large team, where an echo is rare, who has just been met is left out: while robots start all is slow.
        """
        echoes = []
        for name, peer in sorted(self.peers.items(), key=self._echo_order):
            heard = (peer.quickest if quickest else None) or peer.last_heard
            if heard is not None and self._has_started(now, peer):
                echoes.append(_echo(name, peer, heard))
        return tuple(echoes)

    def awaits_echo(self, now: float) -> bool:
        """Whether we have heard of a robot whose digests nobody has echoed yet: it cannot know how long news take."""
        return any(
            not peer.echoed and peer.last_heard is not None and self._has_started(now, peer)
            for peer in self.peers.values()
        )

    def _has_started(self, now: float, peer: Peer) -> bool:
        return len(self.peers) <= MANY or now >= peer.since + STARTS

    def _echo_order(self, entry: tuple[str, Peer]) -> tuple[bool, bool, str]:
        """Who knows no way yet is echoed first; of several each robot begins with another one.

        Where all began with the same one nine of ten robots did not know after 25 s that news took 300 ms.
        """
        name, peer = entry
        return peer.echoed, name < self._tag, name

    def echoed(self, names: Iterable[str]) -> None:
        """Echoes for robots with these tags go out."""
        for name in names:
            self.peers[name].quickest = None
            self.peers[name].echoed = True

    def sent_digest(self, at: float) -> None:
        """A digest of ours goes out."""
        for peer in self.peers.values():
            peer.sent_digest(at)

    def announced(self) -> None:
        """A digest of ours says what we sent until now."""
        self.largest = 0

    def restart_losses(self) -> None:
        """From now on other samples are counted than before."""
        for peer in self.peers.values():
            peer.restart_losses()

    def handed(self, key: str) -> None:
        """A covered sample of ours was handed to the mesh; in broadcast it gets to all, else to those that want it."""
        stream = self._table.known(self.settings.robot, key)
        everybody = self.settings.robot in self._broadcasting
        reached = self.peers if everybody else () if stream is None else self.wanting(stream)
        for name in reached:
            if name in self.peers:
                self.peers[name].sent += 1

    def _heard_echo(self, now: float, peer: Peer, echo: Echo) -> None:
        if echo.peer == self._tag:
            peer.heard_echo(now, echo)
            self._presume_ways()
        elif echo.peer in self.peers:
            self.peers[echo.peer].echoed = True
            if (line := latency_of(echo)) is not None:
                self.peers[echo.peer].heard_by[tag(peer.zid)] = line

    def _presume_ways(self) -> None:
        """Ways without an echo are taken to be as long as the shortest one that is known.

        Where they counted as no time, ten robots with equal messages exceeded the limit in 4 to 16 % of the windows at
        100 and 300 ms though each knew one way, and in 1 to 11 % do so now.
        """
        known = [peer.offset.latency for peer in self.peers.values() if peer.offset.known]
        for peer in self.peers.values():
            peer.offset.presume(min(known, default=0.0))

    def _note_origins(self) -> None:
        """Who claims an origin first has it, unless it is a robot's own id; no plain node has its streams any more."""
        ids = {peer.zid: peer.robot for peer in self.peers.values()}
        claimed = {origin: peer.robot for peer in reversed(self.peers.values()) for origin in peer.origins}
        self._robots = claimed | ids
        self._tags = self.tags()
        self._table.revision += 1
        for stream in self._table.plain():
            robot = self._robots.get(stream.robot.removeprefix(PLAIN))
            if robot is not None:
                self._table.hand_over(stream, robot)

    def _free_name(self, robot: str, zid: str) -> str:
        """The name of a robot, with as much of its id as nobody else's has."""
        taken = {peer.robot for peer in self.peers.values()} | {self.settings.robot}
        names = (robot, *(f"{robot}-{zid[:length]}" for length in range(4, len(zid) + 1)))
        return next((name for name in names if name not in taken), f"{robot}-{zid}")

    def _rename(self, peer: Peer, name: str) -> None:
        """The one that had the name is gone."""
        self._table.rename(peer.robot, name)
        peer.robot = name

    def _note_broadcasting(self) -> None:
        transports = {peer.robot: peer.transport for peer in self.peers.values()}
        transports[self.settings.robot] = self.settings.transport
        broadcasting = {robot for robot, transport in transports.items() if is_broadcast(transport)}
        if broadcasting != self._broadcasting:
            self._table.revision += 1
            self._broadcasting = broadcasting

    def _take(self, now: float, peer: Peer, news: StreamDigest, *, counts: bool = True) -> None:
        """Take in news of a stream. Whether what came of it by now `counts` beside what it says was sent.

        News that waited for its key is older than what came since: where that counted it seemed lost later, and an
        operator of eight robots took 17 % for lost where all came.
        """
        key = peer.keys.get(news.id)
        if key is None:
            earlier = peer.pending.get(news.id)
            if peer.postpone(news) and news.forwarded > (0 if earlier is None else earlier.forwarded):
                self._note_unnamed(now, peer, news)
            return
        stream = self._table.get(now, peer.robot, key)
        if stream is None:
            return
        counts = counts and (peer.robot in self._broadcasting or self._tag in self.wanting(stream))
        peer.heard_news(key, news, counts=counts)
        told = peer.told.get(key)
        if told is not None:
            stream.assume(told)
        t_gen = min(peer.offset.ours(news.t_generated), now)
        before, kind = stream.last, stream.information_type
        # Announcements leave features out, and what is as usual.
        features = kind.heard(news.features) if news.features or before is None else before.features
        news, rhythm = _completed(stream, news, told), rhythm_report.decoded(news, peer.offset.ours)
        last = Generated(t_gen, news.size, news.scale, features)
        stream.note_generated(news.generated, last, told=rhythm)
        t_sent = peer.offset.ours(news.t_forwarded)
        if stream.overheard:
            stream.number(news.forwarded, heard=stream.sent is not None and t_sent < stream.sent.t_sent + SAME)
        if news.forwarded > stream.forwarded:
            self.note_sent(stream, news.forwarded, _last_sent(news, t_sent, last, before))


def _completed(stream: Stream, news: StreamDigest, told: StreamState | None) -> StreamDigest:
    """Return news with what an announcement leaves out because it is as usual."""
    if news.size and news.scale >= 0.0:
        return news
    size = news.size or (told.size if told is not None else stream.newest.size if stream.last else 0)
    return replace(news, size=size, scale=news.scale if news.scale >= 0.0 else usual_scale(stream))


def _last_sent(news: StreamDigest, t_sent: float, last: Generated, before: Generated | None) -> Sent:
    """What a stream last sent: news tells when it was sent, and what was last generated, be that sent or not.

    What was generated later than that was sent is another sample: then the one before is the best that we know.
    """
    like = last if news.t_forwarded >= news.t_generated or before is None else before
    return Sent(t_sent, t_sent, like.size, like.scale, like.features)


def _echo(name: str, peer: Peer, heard: HeardDigest) -> Echo:
    line = peer.latency_in
    told = Latency(0.0) if line is None else Latency(max(line.fixed, LEAST_LATENCY), line.per_byte)
    return Echo(name, heard.sent, heard.received, heard.samples, told.fixed, told.per_byte)
