"""How old news of other robots is when it comes, and until when it tells of their streams."""

from collections import deque
from collections.abc import Iterable, Mapping

from proxy.core.protocol.messages import Digest
from proxy.core.view.peer import Peer
from proxy.core.view.tuning import TUNING


class Staleness:
    """What digests take to come, and when the last one of each robot was sent."""

    def __init__(self, peers: Mapping[str, Peer]) -> None:
        self._peers = peers
        self._reported_until: dict[str, float] = {}
        """When the last digest of each robot was sent [s, our clock], announcements aside."""
        self._delays: deque[float] = deque(maxlen=TUNING.digest_delays)
        """What the last digests took beyond the quickest of their robots [s]."""

    def heard(self, now: float, peer: Peer, digest: Digest) -> None:
        """A digest of a peer came. An announcement does not tell that the streams which it leaves out are silent."""
        sent = peer.offset.ours(digest.sent)
        self._delays.append(max(0.0, now - sent - peer.offset.latency))
        if not digest.brief:
            self._reported_until[peer.robot] = min(now, sent)

    def forget(self, robot: str) -> None:
        """A robot left."""
        self._reported_until.pop(robot, None)

    def reported_until(self, robot: str, otherwise: float) -> float:
        """When the last digest of a robot was sent [s, our clock]; `otherwise` where none tells of its streams."""
        return self._reported_until.get(robot, otherwise)

    def all_reported_until(self, robots: Iterable[str], otherwise: float) -> list[float]:
        """Return the same for many robots."""
        reported_until = self._reported_until.get
        return [reported_until(robot, otherwise) for robot in robots]

    @property
    def longest_way(self) -> float:
        """What digests take at least from or to any peer, at most [s]."""
        return max((peer.offset.latency for peer in self._peers.values()), default=0.0)

    @property
    def delay(self) -> float:
        """What all but few digests take beyond their least [s]: they wait for other messages, and for processors."""
        return sorted(self._delays)[int(TUNING.digests_in_time * len(self._delays))] if self._delays else 0.0
