"""The shared view: what this robot knows of streams, robots, and what the channel carries."""

from proxy.core.model.limits import allowance_of
from proxy.core.model.settings import CoreSettings, is_broadcast
from proxy.core.protocol.messages import Digest, State, tag
from proxy.core.view.audience import Audiences, Paths
from proxy.core.view.contention import Contention
from proxy.core.view.echoes import Echoes
from proxy.core.view.members import Members
from proxy.core.view.newcomers import Newcomers
from proxy.core.view.news import News
from proxy.core.view.overhearing import Origins, Overhearing
from proxy.core.view.peer import Staleness
from proxy.core.view.streams import Streams
from proxy.core.view.subscribers import Subscribers
from proxy.core.view.traffic import TrafficLog
from proxy.core.view.tuning import TUNING
from proxy.core.view.wall import WallClocks
from utility_specs import Specs


class SharedView:
    """The parts of the view, and what concerns several of them: who comes and leaves, what robots tell each other."""

    def __init__(self, settings: CoreSettings, specs: Specs) -> None:
        own = tag(settings.zid)
        self.settings = settings
        self.streams = Streams(settings, specs)
        self.members = Members(settings)
        self.peers = self.members.peers
        self.origins = Origins(settings, self.streams, self.members)
        self.subscribers = Subscribers(settings, self.streams, self.members)
        self.newcomers = Newcomers(self.peers, self.streams, self.subscribers)
        self.traffic = TrafficLog(settings.robot, self.members, self.subscribers)
        self.staleness = Staleness(self.peers)
        self.echoes = Echoes(own, self.peers)
        self.clocks = WallClocks(settings, self.peers)
        self.paths = Paths(settings, self.members)
        self.audiences = Audiences(settings, self.members, self.subscribers, self.paths)
        self.contention = Contention(self.streams, self.subscribers, self.staleness)
        self.overhearing = Overhearing(self.streams, self.members, self.origins, self.traffic)
        self._news = News(own, self.streams, self.subscribers, self.traffic)

    @property
    def specs(self) -> Specs:
        """The specs in force."""
        return self.streams.specs

    def words_take(self, robots: int) -> float:
        """Return how long it takes until each of so many robots has said a word to every other, as allowed [s]."""
        words = robots if is_broadcast(self.settings.transport) else robots * (robots - 1)
        return words * TUNING.word_size / allowance_of(self.specs, self.settings.allowance, robots)

    @property
    def evicted(self) -> int:
        """How much had to be forgotten: streams, keys of ours that somebody wants, origins, robots."""
        return self.streams.evicted + self.origins.evicted + self.members.evicted

    def add_peer(self, now: float, robot: str, zid: str) -> bool:
        """A robot's presence token appeared; False when we know it already, or there are too many."""
        if self.members.knows(zid):
            return False
        if len(self.peers) >= TUNING.peers:
            leaving = self.members.evict()
            if leaving is None:
                return False
            self.gone(now, leaving.zid)
        self.members.add(now, robot, zid, plain=self.newcomers.in_doubt(now))
        self.newcomers.met(now)
        self.echoes.presume_ways()
        self.origins.assign()
        return True

    def gone(self, now: float, zid: str) -> None:
        """A robot left: it and its streams take no part in plans any more."""
        peer = self.members.remove(zid)
        if peer is None:
            return
        self.origins.part(now, peer)
        self.subscribers.set(peer.tag, ())
        self.clocks.forget(peer.tag)
        for other in self.peers.values():
            other.heard_by.pop(peer.tag, None)
            other.came.pop(peer.tag, None)
        for stream in self.streams:
            stream.miss((peer.tag,))
        for stream in self.streams.of(peer.robot):
            self.streams.forget(stream)
        self.staleness.forget(peer.robot)
        heir = self.members.heir_of(peer.robot)
        if heir is not None:
            self.streams.rename(heir.robot, heir.name)
            self.staleness.rename(heir.robot, heir.name)
            self.members.restore_name(heir)
        self.origins.assign()
        self.subscribers.note_transports()

    def heard_digest(self, now: float, digest: Digest) -> bool:
        """A peer's digest arrived; False when it is unknown, old or our own."""
        peer = self.peers.get(digest.tag)
        if peer is None or (peer.digest is not None and digest.sent <= peer.digest.sent):
            return False
        if peer.state.specs != self.specs.generation:
            peer.restart_losses()  # it may not count what we count
        peer.heard_digest(now, digest)
        self.staleness.heard(now, peer, digest)
        if digest.state == peer.state.number:
            self.clocks.bound(now, peer)
        for echo in digest.echoes:
            if echo.received <= digest.sent:  # nobody has heard what is yet to come
                self.echoes.heard(now, peer, echo)
        if not is_broadcast(peer.state.transport):
            peer.inbound.heard_digest(now, digest.sent, TUNING.usual_digest)
        self._news.take(now, peer, digest)
        return True

    def heard_state(self, now: float, state: State) -> bool:
        """A peer's state arrived; False when it is unknown, or the state an update of one that we do not have."""
        peer = self.peers.get(tag(state.zid))
        whole = None if peer is None else peer.whole(state)
        if peer is None or whole is None:
            return False
        subscriptions, origins = peer.state.subscriptions, peer.state.origins
        peer.take_state(now, whole)
        self.clocks.bound(now, peer)
        self.subscribers.note_transports()
        if peer.state.subscriptions != subscriptions:
            self.subscribers.set(peer.tag, peer.state.subscriptions)
        if peer.state.origins != origins:
            self.origins.assign()
        self._news.take_state(now, peer)
        return True

    def sweep(self, now: float) -> None:
        """Forget silent streams of plain nodes, and sends no window counts for long; cheap to call at every event."""
        self.streams.sweep(now)
        self.traffic.sweep(now, max((each.measure.window for each in self.specs.constraints), default=0.0))

    def sent_digest(self, at: float) -> None:
        """A digest of ours goes out."""
        for peer in self.peers.values():
            peer.outbound.sent_digest(at)

    def restart_losses(self) -> None:
        """Forget the counts of all peers: from now on other samples are counted."""
        for peer in self.peers.values():
            peer.restart_losses()

    def handed(self, key: str, count: int = 1) -> None:
        """Covered samples of ours were handed to the mesh; in broadcast they get to all, else to who wants them."""
        stream = self.streams.known(self.settings.robot, key)
        everybody = self.subscribers.broadcasts(self.settings.robot)
        for name in self.peers if everybody else () if stream is None else self.subscribers.of(stream):
            if (peer := self.peers.get(name)) is not None:
                peer.outbound.handed(count)
