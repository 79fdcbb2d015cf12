"""The robots that have been met lately, and those that only listen."""

import math
from collections.abc import Mapping

from proxy.core.view.peer import Peer
from proxy.core.view.streams import Streams
from proxy.core.view.subscribers import Subscribers
from proxy.core.view.tuning import TUNING


class Newcomers:
    """Which robots have been met lately, and which of them may still tell what they sent."""

    def __init__(self, peers: Mapping[str, Peer], streams: Streams, subscribers: Subscribers) -> None:
        self._peers = peers
        self._streams = streams
        self._subscribers = subscribers
        self._met_at = -math.inf
        self._doubted_at = -math.inf
        """When somebody last turned out to say nothing [s]."""

    def met(self, now: float) -> None:
        """A robot was met."""
        self._met_at = now

    def doubt(self, now: float, peer: Peer) -> None:
        """A robot leaves, or has been there for long: if it has said nothing, others like it may come."""
        if peer.silent:
            self._doubted_at = now

    def in_doubt(self, now: float) -> bool:
        """Whether who comes now, to a team that has begun, may be nobody, and takes part from its first word on."""
        since = now - TUNING.team_begins
        return now < self._doubted_at + TUNING.doubt_time or any(
            peer.since <= since and not peer.silent for peer in self._peers.values()
        )

    def met_lately(self, now: float) -> list[Peer]:
        """Return the robots of which little may be known yet: they, or our own streams, have just come."""
        began, time = self._began(), TUNING.newcomer_time
        return [peer for peer in self._peers.values() if now < max(peer.since, began) + time and not peer.plain]

    def little_known(self, now: float, words_take: float) -> list[Peer]:
        """Return those of which it may not be known what they send, as they have just come or had no word left since.

        It takes so long until each robot has said one to every other [s]; after several times that all have. In large
        teams it takes minutes, and few send: there only who has just come. Of thirteen robots on 0.3 Mbit/s whose
        applications began 5 s after the daemons each knew of one stream after 15 s, and took the others to send
        nothing: twice the limit.
        """
        peers = [peer for peer in self._peers.values() if not peer.plain]
        began, time = self._began(), TUNING.newcomer_time
        few = len(peers) <= TUNING.newcomers
        longest = max(time, TUNING.newcomer_words * words_take) if few else time
        sending, untold, listening = list[Peer](), list[Peer](), TUNING.newcomer_doubt
        for peer in peers:
            if self.only_listens(peer):
                listening += 1
            elif not self._is_untold(peer):
                sending.append(peer)
            elif now < max(peer.since, began) + longest:
                untold.append(peer)
        # Of those that have not told yet as many send as of the others, as far as one can say.
        part = (len(sending) + TUNING.newcomer_doubt) / (len(sending) + listening)
        lately = [peer for peer in sending if now < max(peer.since, began) + time]
        return lately + untold[: math.ceil(part * len(untold))]

    def greeted_by(self, now: float) -> float:
        """Until when a robot that has just been met may tell what it sent lately [s]; −∞: all have, or are tokens."""
        time = TUNING.greeting_time
        if now >= self._met_at + time:
            return -math.inf
        waited_for = now >= self._doubted_at + TUNING.doubt_time
        new = (p for p in self._peers.values() if p.last_heard is None and (not p.plain or (waited_for and p.silent)))
        return max((peer.since + time for peer in new if not peer.announced or peer.told), default=-math.inf)

    def only_listens(self, peer: Peer) -> bool:
        """Whether a robot has sent nothing though we have sent for a while: an operator only listens.

        Not one with samples that others want, and no room: else 13 % of the windows of eight robots were over.
        """
        if peer.counted is None:
            return False
        told_at, messages, _ = peer.counted
        if messages or told_at < max(peer.since, self._began()) + TUNING.silent_since_start:
            return False
        return not any(map(self._subscribers.count, self._streams.of(peer.robot)))

    def _is_untold(self, peer: Peer) -> bool:
        """Whether nothing is known of what a robot sends."""
        return not any(stream.generated for stream in self._streams.of(peer.robot))

    def _began(self) -> float:
        return min((stream.began for stream in self._streams.own()), default=-math.inf)
