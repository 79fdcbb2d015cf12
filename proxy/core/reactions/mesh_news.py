"""What is heard on the mesh: samples, digests and states of other robots, and what is none of these."""

from collections import Counter

from proxy.core.interface import events as ev
from proxy.core.interface.commands import Command, NoteInterest, Notice
from proxy.core.parts import Parts
from proxy.core.protocol.messages import Digest, StreamDigest, tag
from proxy.core.reactions.retention import Retention
from proxy.core.status import OTHER_VERSION
from proxy.core.view.peer import Peer
from proxy.core.view.plausible import objection, objection_to_state
from proxy.core.view.stream import Stream
from proxy.core.view.tuning import TUNING as VIEW
from proxy.core.view.warnings import transport_warnings


class MeshNews:
    """`refused` counts by kind what was heard on Sendworthy's keys and changed nothing."""

    def __init__(self, parts: Parts, retention: Retention) -> None:
        self._parts = parts
        self._retention = retention
        self.refused: Counter[str] = Counter()
        self.misread_at: float | None = None
        """When a message of another version was heard last [s]."""

    def hear(self, now: float, digest: Digest, size: int) -> list[Command]:
        """Take in a digest of so many bytes, if it is one that its robot can have sent."""
        peer = self._parts.view.peers.get(digest.tag)
        if peer is None:
            if digest.tag == tag(self._parts.settings.zid):
                self.refused["digest:forged"] += 1
            else:
                self._parts.unknown_senders.keep(now, digest)
            return []
        if wrong := self._objection(now, peer, digest):
            self.refused[wrong] += 1
            return []
        if peer.digest is not None and now - peer.digest_received > VIEW.implausible_for:
            peer.restart()
        if self._parts.view.heard_digest(now, digest):
            self._parts.coordination.heard(now, digest)
            self._parts.mismatched.heard(digest.tag)
            self._parts.gossip.account.heard_digest(now, size)
            self._parts.channel.capacity.digest_received(now, digest, self._parts.gossip.account.paid_at(now))
            self._parts.gossip.requests.compare(now, digest.tag, peer)
        return self._parts.view.clocks.compare(now, (peer,))

    def _objection(self, now: float, peer: Peer, digest: Digest) -> str:
        def known(news: StreamDigest) -> Stream | None:
            return self._parts.view.streams.known(peer.robot, peer.keys.get(news.id, ""))

        return objection(now, peer, digest, known)

    def state(self, event: ev.StateHeard) -> list[Command]:
        """A state arrived; that of a robot that we do not know yet is asked for when we do."""
        name = tag(event.state.zid)
        peer = self._parts.view.peers.get(name)
        if peer is None:
            return []
        if wrong := objection_to_state(peer, event.state):
            self.refused[wrong] += 1
            return []
        self._parts.gossip.account.heard_state(event.now, event.state, event.size)
        self._parts.coordination.heard(event.now, event.state)
        warned = transport_warnings(self._parts.settings, self._parts.view.peers)
        subscriptions = peer.state.subscriptions
        if self._parts.view.heard_state(event.now, event.state):
            self._parts.mismatched.heard(name)
            self._parts.gossip.requests.compare(event.now, name, peer)
        else:
            self._parts.gossip.requests.want(event.now, name)
        commands: list[Command] = []
        if peer.state.subscriptions != subscriptions:
            commands.append(NoteInterest(peer.zid, peer.state.subscriptions))
        if peer.announced:
            self._parts.kept.subscribed(name, peer.state.subscriptions)
            commands += self._retention.renew()
        after = transport_warnings(self._parts.settings, self._parts.view.peers)
        commands += [Notice("error", warning, {"reason": "transport"}) for warning in after if warning not in warned]
        return [*commands, *self._parts.view.clocks.compare(event.now, self._parts.view.peers.values())]

    def malformed(self, event: ev.MalformedHeard) -> None:
        """Something on a key of ours was no digest and no state."""
        self.refused[event.kind] += event.count
        if event.kind.endswith(OTHER_VERSION):
            self.misread_at = event.now

    def version(self, event: ev.VersionHeard) -> None:
        """A robot speaks this version of the protocol."""
        if (peer := self._parts.view.peers.get(event.tag)) is not None:
            peer.speak(event.version)
