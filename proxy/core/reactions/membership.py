"""Robots that appear on the mesh and vanish from it."""

from planner import Aggregation
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Command, NoteInterest, Notice
from proxy.core.parts import Parts
from proxy.core.protocol.messages import tag
from proxy.core.reactions.changes import TeamLimits
from proxy.core.reactions.mesh_news import MeshNews
from proxy.core.reactions.retention import Retention
from proxy.core.samples.away import Leaving
from proxy.core.view.peer import Peer
from proxy.core.view.warnings import namesake_warnings


class Membership:
    """Takes robots into the view and out of it."""

    def __init__(self, parts: Parts, limits: TeamLimits, news: MeshNews, retention: Retention) -> None:
        self._parts = parts
        self._limits = limits
        self._news = news
        self._retention = retention

    def appeared(self, event: ev.PeerAppeared) -> list[Command]:
        """A presence token appeared."""
        warned, known = namesake_warnings(self._parts.settings, self._parts.view.peers), dict(self._parts.view.peers)
        name = tag(event.zid)
        if event.zid == self._parts.settings.zid or not self._parts.view.add_peer(event.now, event.robot, event.zid):
            self._lost_for_a_moment(event)
            return []
        for other in known.keys() - self._parts.view.peers.keys():  # it had to leave for the new one
            self._forget(other)
        self._parts.mismatched.met(name, self._parts.view.peers[name])
        self._limits.set_members(event.now)
        self._parts.gossip.met(event.now, name)
        robot = self._parts.view.peers[name].robot
        commands: list[Command] = [Notice("info", f"robot {robot} is on the mesh", _fields(robot))]
        self._parts.kept.appeared(event.robot, name)
        for stream in self._parts.view.streams.own():
            if stream.key in self._parts.kept.reached(name):
                stream.reach((name,))
        for heard, digest in self._parts.unknown_senders.introduce(name):
            commands += self._news.hear(heard, digest, 0)
        after = namesake_warnings(self._parts.settings, self._parts.view.peers)
        new = [warning for warning in after if warning not in warned]
        return [*commands, *(Notice("error", warning, {"reason": "namesake"}) for warning in new)]

    def gone(self, event: ev.PeerGone) -> list[Command]:
        """A presence token vanished."""
        peer = self._parts.view.peers.get(tag(event.zid))
        if peer is None or not _is(peer, event):  # a token in another robot's name is nothing to this one
            return []
        robot = peer.robot
        self._parts.view.newcomers.doubt(event.now, peer)
        self._parts.kept.lost(event.now, self._leaving(peer))
        self._parts.view.gone(event.now, event.zid)
        self._forget(tag(event.zid))
        self._limits.set_members(event.now)
        notice = Notice("info", f"robot {robot} left the mesh", _fields(robot))
        return [*self._retention.renew(), NoteInterest(event.zid, ()), notice]

    def _lost_for_a_moment(self, event: ev.PeerAppeared) -> None:
        """The token of a robot that we know appears: it had vanished, too shortly for us to hear of it."""
        name = tag(event.zid)
        peer = self._parts.view.peers.get(name)
        if peer is not None and _is(peer, event) and peer.announced:
            self._parts.kept.lost(event.now, self._leaving(peer))
            self._parts.kept.appeared(peer.name, name)
            self._parts.kept.subscribed(name, peer.state.subscriptions)

    def _leaving(self, peer: Peer) -> Leaving:
        name = tag(peer.zid)
        once = [s for s in self._parts.view.streams.own() if s.information_type.aggregation is Aggregation.ONCE]
        reached = frozenset(stream.key for stream in once if name in stream.reached)
        return Leaving(
            peer.name, name, peer.state.subscriptions, reached, peer.state.specs == self._parts.view.specs.generation
        )

    def _forget(self, name: str) -> None:
        """The robot with this tag is not in the view any more."""
        self._parts.gossip.requests.done(name)
        self._parts.channel.capacity.forget(name)


def _is(peer: Peer, event: ev.PeerAppeared | ev.PeerGone) -> bool:
    """Whether a token is that of a robot: its session, under its name."""
    return (peer.name, peer.zid) == (event.robot, event.zid)


def _fields(robot: str) -> dict[str, str | int]:
    """Return what programs look for in the log; of one reason no more is logged than somebody reads."""
    return {"robot": robot, "reason": "presence"}
