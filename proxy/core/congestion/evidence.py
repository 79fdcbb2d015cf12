"""What this robot itself sees of the channel, by the digests that it sends and receives."""

from collections.abc import Collection

from proxy.core.congestion.delivery_ratio import DeliveryRatio
from proxy.core.congestion.liveness import Liveness
from proxy.core.congestion.load import Load
from proxy.core.congestion.queue_delay import PathDelays, StandingQueue, standing_queue
from proxy.core.congestion.tuning import TUNING
from proxy.core.protocol.messages import Digest


class Evidence:
    """Delays, silence, loss and load."""

    def __init__(self, now: float, own: str) -> None:
        self._own = own
        self.paths: dict[str, PathDelays] = {}
        """By tag, of the robots that are there."""
        self.liveness = Liveness(now)
        self.delivery = DeliveryRatio()
        self.load = Load()
        self._messages: dict[float, int] = {}
        """How many messages we had put on the air when our last digests were sent."""

    def digest_sent(self, now: float, messages: int) -> None:
        """We send a digest, and had put so many messages on the air: its echo tells how many of them arrived."""
        self._messages[now] = messages
        if len(self._messages) > TUNING.remembered:
            del self._messages[next(iter(self._messages))]

    def digest_received(self, now: float, digest: Digest) -> None:
        """A digest of another robot arrived."""
        if not self.paths:
            self.liveness.restart(now)
        path = self.paths.setdefault(digest.tag, PathDelays())
        if path.inbound.note(now, digest.sent, now):
            self.liveness.digest_received(now, path.inbound.last)
        for echo in digest.echoes:
            if echo.peer == self._own and path.outbound.note(now, echo.sent, echo.received):
                self.liveness.echo_received(now)
                if echo.sent in self._messages:
                    self.delivery.note(now, self._messages[echo.sent], digest.tag, echo.samples)
        if not digest.brief:
            self.load.note(now, digest.tag, digest.sent, digest.messages, digest.bytes)

    def link_gauged(self, now: float, peer: str, delay: float) -> None:
        """Our own socket tells that what we send a robot now is that long on its way [s]."""
        if peer in self.paths:
            self.paths[peer].link.note(now + delay, now, now + delay)

    def sent(self, now: float, messages: int, size: int) -> None:
        """We have put so much on the air so far."""
        self.load.note(now, self._own, now, messages, size)

    def forget(self, peer: str) -> None:
        """A robot left."""
        self.paths.pop(peer, None)
        self.load.forget(peer)
        self.delivery.forget(peer)

    def queue(
        self, now: float, receivers: Collection[str], since: float, bearable: float, span: float
    ) -> StandingQueue | None:
        """The longest queue that stands before what comes here, or before what we send to our receivers, for a `span`.

        What went into a queue before `since` does not count.
        """
        recent = now - max(TUNING.recent_delays, 2.0 * self.liveness.interval(now))
        outward = [path for peer, path in self.paths.items() if not receivers or peer in receivers]
        directions = (
            [path.inbound for path in self.paths.values()],
            [path.outbound for path in outward],
            [path.link for path in outward],
        )
        found = [standing_queue(now, each, since, bearable / 2.0, recent=recent, span=span) for each in directions]
        return max((each for each in found if each), key=lambda each: each.delay, default=None)
