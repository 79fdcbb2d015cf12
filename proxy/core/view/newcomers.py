"""Robots that have just come: the others know little of them, and they know little of the others."""

import math
from collections.abc import Mapping

from proxy.core.view.peer import Peer
from proxy.core.view.streams import Streams
from proxy.core.view.tuning import TUNING


class Newcomers:
    """Which robots have been met lately, and which of them may still tell what they sent."""

    def __init__(self, peers: Mapping[str, Peer], streams: Streams) -> None:
        self._peers = peers
        self._streams = streams
        self._met_at = -math.inf
        """When a robot was met last [s]."""

    def met(self, now: float) -> None:
        """A robot was met."""
        self._met_at = now

    def met_lately(self, now: float) -> list[Peer]:
        """Return the robots of which little may be known yet: they, or our own streams, have just come.

        Teams are often switched on before anything is sent.
        """
        began, time = self._began(), TUNING.newcomer_time
        return [peer for peer in self._peers.values() if now < max(peer.since, began) + time and not peer.plain]

    def greeted_by(self, now: float) -> float:
        """Until when a robot that has just been met may still tell what it sent lately [s]; −∞ where all have told."""
        time = TUNING.greeting_time
        if now >= self._met_at + time:
            return -math.inf
        new = (p for p in self._peers.values() if p.last_heard is None and not p.plain)
        return max((peer.since + time for peer in new if peer.state is None or peer.told), default=-math.inf)

    def only_listens(self, peer: Peer) -> bool:
        """Whether a robot has sent nothing though we have sent for a while: an operator only listens."""
        if peer.counted is None:
            return False
        told_at, messages, _ = peer.counted
        return messages == 0 and told_at >= max(peer.since, self._began()) + TUNING.silent_since_start

    def _began(self) -> float:
        return min((stream.began for stream in self._streams.own()), default=-math.inf)
