"""Echoes: what robots tell each other of the last digests and samples that they heard, for clocks and latencies."""

from collections.abc import Iterable, Mapping

from proxy.core.protocol.messages import Echo
from proxy.core.protocol.tuning import TUNING as BOUNDS
from proxy.core.transit.latency import Latency
from proxy.core.transit.outbound import latency_of
from proxy.core.view.peer import HeardDigest, Peer
from proxy.core.view.tuning import TUNING


class Echoes:
    """Whom we echo next, and what echoes of others tell; `own` is our tag."""

    def __init__(self, own: str, peers: Mapping[str, Peer]) -> None:
        self._own = own
        self._peers = peers

    def due(self, now: float, *, quickest: bool = False) -> tuple[Echo, ...]:
        """Echo the last digest of each peer, or the `quickest` one, and what its samples take; of many no new one."""
        echoes = []
        for name, peer in sorted(self._peers.items(), key=self._order):
            heard = (peer.quickest if quickest else None) or peer.last_heard
            if heard is not None and self._has_started(now, peer):
                echoes.append(_echo(name, peer, heard))
        return tuple(echoes)

    def are_awaited(self, now: float) -> bool:
        """Whether we have heard of a robot whose digests nobody has echoed yet: it cannot know how long news take."""
        return any(
            not peer.echoed and peer.last_heard is not None and self._has_started(now, peer)
            for peer in self._peers.values()
        )

    def sent(self, names: Iterable[str]) -> None:
        """Echoes for robots with these tags go out."""
        for name in names:
            self._peers[name].note_echo(ours=True)

    def heard(self, now: float, peer: Peer, echo: Echo) -> None:
        """A peer echoes a digest, of ours or of another robot."""
        if echo.peer == self._own:
            peer.outbound.heard_echo(now, echo)
            self.presume_ways()
        elif (other := self._peers.get(echo.peer)) is not None:
            other.note_echo(ours=False)
            other.came[peer.tag] = now, echo.samples
            if (line := latency_of(echo)) is not None:
                other.heard_by[peer.tag] = line

    def presume_ways(self) -> None:
        """Ways without an echo are taken to be as long as the shortest way that is known.

        Taken to need no time ten robots had 4 to 16 % of the windows over the limit, and have 1 to 11 (100 and 300 ms).
        """
        known = [peer.offset.latency for peer in self._peers.values() if peer.offset.known]
        for peer in self._peers.values():
            peer.offset.presume(min(known, default=0.0))

    def _has_started(self, now: float, peer: Peer) -> bool:
        return len(self._peers) <= TUNING.peers_always_echoed or now >= peer.since + TUNING.unechoed_after_meeting

    def _order(self, entry: tuple[str, Peer]) -> tuple[bool, bool, str]:
        """Robots that know no way first, from another one on for each of us: else nine of ten knew none after 25 s."""
        name, peer = entry
        return peer.echoed, name < self._own, name


def _echo(name: str, peer: Peer, heard: HeardDigest) -> Echo:
    line = peer.inbound.latency
    said = Latency(0.0) if line is None else Latency(max(line.fixed, TUNING.least_latency), line.per_byte)
    fixed, per_byte = (min(each, BOUNDS.latency) for each in (said.fixed, said.per_byte))
    return Echo(name, heard.sent, heard.received, heard.samples, fixed, per_byte)
