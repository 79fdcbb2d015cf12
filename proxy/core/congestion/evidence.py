"""What this robot itself sees of the channel, by the digests that it sends and receives."""

import math
from bisect import bisect_left
from collections import deque
from collections.abc import Collection, Iterable, Sequence
from itertools import pairwise
from operator import itemgetter
from statistics import median

from proxy.core.congestion.queue_delay import PathDelays, StandingQueue, standing_queue
from proxy.core.congestion.tuning import TUNING
from proxy.core.model.limits import Limit
from proxy.core.protocol.messages import Digest

_Arrived = tuple[float, int, int]
"""When a robot reported it [s]: the messages that we had sent to anybody, and those that had arrived there."""


class DeliveryRatio:
    """Our messages of the recent past, sent and arrived, against the usual part: loss that was not there before.

    A decrease for loss is a trial: where as much is lost when less is sent, the radio is taken to be worse than it was.
    """

    def __init__(self) -> None:
        self._reports: dict[str, deque[_Arrived]] = {}
        self._ratios: deque[tuple[float, float]] = deque(maxlen=TUNING.remembered)
        self._congested_until = 0.0
        self._usual_before = 0.0
        """What was usual when load was last found to be the cause of loss."""

    def note(self, now: float, sent: int, peer: str, received: int) -> None:
        """When we had sent so many messages so far, copies counted, a peer had received so many of them."""
        if (before := self._reports.get(peer)) is not None and received < before[-1][2]:
            self.forget(peer)
        reports = self._reports.setdefault(peer, deque(maxlen=TUNING.remembered))
        reports.append((now, sent, received))
        while len(reports) > 2 and reports[1][0] <= now - 2.0 * TUNING.ratio_span:
            reports.popleft()
        if (ratio := _delivered(self._reports.values())) is not None:
            self._ratios.append((now, ratio))
        while self._ratios and self._ratios[0][0] < now - TUNING.usual_span:
            self._ratios.popleft()

    def forget(self, peer: str) -> None:
        """A robot left or started anew: what arrived until now is not comparable."""
        self._reports.pop(peer, None)
        self.accept()

    def accept(self) -> None:
        """What is lost now is how the radio is."""
        self._ratios.clear()
        self._congested_until = self._usual_before = 0.0

    def attribute_to_load(self, now: float) -> None:
        """What is lost now is lost by load: for a while it does not become usual."""
        self._congested_until, self._usual_before = now + TUNING.usual_span, self._usual(now)

    def excess_loss(self, now: float) -> float:
        """The part that was lost at last beyond the usual; 0 while nothing is known."""
        if not self._ratios or self._ratios[-1][0] < now - TUNING.ratio_span:
            return 0.0
        usual = self._usual(now)
        return max(0.0, 1.0 - self._ratios[-1][1] / usual) if usual > 0.0 else 0.0

    def congested(self, now: float) -> bool:
        """Whether load was found to be the cause of loss lately."""
        return now < self._congested_until

    def _usual(self, now: float) -> float:
        usual = median(ratio for _, ratio in self._ratios)
        return max(usual, self._usual_before) if self.congested(now) else usual


def _delivered(robots: Collection[Sequence[_Arrived]]) -> float | None:
    """Return which part arrived of the messages that all robots reported on; None: of too few, in too short a time.

    Robots report at different times, each on what had been sent by then: what had arrived at the others when as much
    had been sent lies between two of their reports. With the last report of each as it was two robots of 27 samples a
    second took a third for lost on a radio that lost 1 %, and halved a limit that was half used.
    """
    since = min(reports[-1][0] for reports in robots) - TUNING.ratio_span
    before = [[report for report in reports if report[0] <= since] for reports in robots]
    if not all(before):
        return None
    first, last = max(reports[-1][1] for reports in before), min(reports[-1][1] for reports in robots)
    if last - first < TUNING.ratio_messages:
        return None
    return sum(_arrived(reports, last) - _arrived(reports, first) for reports in robots) / (last - first)


def _arrived(reports: Sequence[_Arrived], sent: int) -> float:
    """Return how many messages had arrived at a robot when so many had been sent."""
    place = min(max(bisect_left(reports, sent, key=itemgetter(1)), 1), len(reports) - 1)
    (_, sent0, arrived0), (_, sent1, arrived1) = reports[place - 1], reports[place]
    return arrived1 if sent1 == sent0 else arrived0 + (arrived1 - arrived0) * (sent - sent0) / (sent1 - sent0)


_Counts = tuple[float, float, int, int]
"""When we got to know them and when they held [s], messages and bytes, copies counted."""


class Load:
    """Messages and bytes per second on the air."""

    def __init__(self) -> None:
        self._reported: dict[str, deque[_Counts]] = {}

    def note(self, now: float, robot: str, at: float, messages: int, size: int) -> None:
        """At `at` on its own clock, a robot had put so many messages of so many bytes in all on the air."""
        counts = self._reported.setdefault(robot, deque(maxlen=TUNING.remembered))
        if counts and at <= counts[-1][1]:
            return
        counts.append((now, at, messages, size))
        while len(counts) > 2 and counts[1][1] <= at - TUNING.rate_span:
            counts.popleft()

    def forget(self, robot: str) -> None:
        """A robot left."""
        self._reported.pop(robot, None)

    def parts(self, now: float, limits: Iterable[Limit]) -> tuple[float, ...]:
        """Return the part of each limit that is used."""
        rates = [_rates(counts) for counts in self._reported.values() if counts[-1][0] >= now - TUNING.lifetime]
        return tuple(sum(_use(limit, *rate) for rate in rates) * limit.window / limit.limit for limit in limits)


def _rates(counts: deque[_Counts]) -> tuple[float, float]:
    (_, t0, messages, size), (_, t1, more, larger) = counts[0], counts[-1]
    apart = t1 - t0
    return (max(0, more - messages) / apart, max(0, larger - size) / apart) if apart > 0.0 else (0.0, 0.0)


def _use(limit: Limit, messages: float, size: float) -> float:
    """What so many messages of so many bytes in all use in a second, each a transmission of its own."""
    return messages * limit.measure.use(round(size / messages), 1, own=False) if messages > 0.0 else 0.0


class Liveness:
    """When we last sent a digest, when one of another robot came, and when an echo told that ours arrived."""

    def __init__(self, now: float) -> None:
        self._sent: deque[float] = deque((now,), maxlen=5)
        self._received = self._newest = now
        self._echoed: deque[float] = deque((now,), maxlen=5)
        self._excused_until = now
        """Until then the allowance of all pays for what was heard: that nobody says more is no silence [s].

        After all that a team tells at first, which takes half a minute's allowance where limits are low, robots took
        the silence for a dead channel, lowered their limits further, and so had still less to tell it with: four behind
        300 kbit/s sent next to nothing for the rest of their flight.
        """

    @property
    def last_sent(self) -> float:
        """When our last digest was sent [s]."""
        return self._sent[-1]

    def digest_sent(self, now: float) -> None:
        """We send a digest."""
        self._sent.append(now)

    def digest_received(self, now: float, waited: float = 0.0, paid_at: float = -math.inf) -> None:
        """A digest of another robot arrived that had waited so long on its way [s]; all are in debt until `paid_at`."""
        self._received = now
        self._excused_until = max(self._excused_until, paid_at)
        self._newest = max(self._newest, now - waited)

    def echo_received(self, now: float) -> None:
        """Another robot echoes a digest of ours for the first time."""
        self._echoed.append(now)

    def restart(self, now: float) -> None:
        """Nobody was there to be heard until now."""
        self._received = self._newest = now
        self._echoed = deque((now,), maxlen=5)

    def interval(self, now: float) -> float:
        """The longest time between two of our last digests [s]; the others' are as far apart."""
        return _longest((*self._sent, now))

    def overdue(self, now: float, bearable: float, robots: int) -> bool:
        """Whether a digest of the others should have come by now: it waits somewhere."""
        usual = max(TUNING.overdue, TUNING.overdue_intervals * self.interval(now) / min(robots, 2))
        return self.staleness(now) > bearable + usual

    def staleness(self, now: float) -> float:
        """How old the newest news is that we have [s]."""
        return now - self._newest

    def silent(self, now: float) -> bool:
        """Whether nothing gets through, one way or the other."""
        silence = max(TUNING.silence, TUNING.silence_intervals * self.interval(now))
        rare = min(TUNING.echo_intervals * _longest(self._echoed), TUNING.longest_echo_silence)
        if now - max(self._received, self._excused_until) > silence:
            return True
        # Who says nothing echoes nothing: that tells only of the others' silence.
        return self._received - self._echoed[-1] > max(TUNING.echo_silence * silence, rare)


def _longest(times: Iterable[float]) -> float:
    """The longest time between two of these that follow each other [s]."""
    return max((after - before for before, after in pairwise(times)), default=0.0)


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

    def digest_received(self, now: float, digest: Digest, paid_at: float = -math.inf) -> None:
        """A digest of another robot arrived; the allowance pays until `paid_at` [s] for what all told so far."""
        if not self.paths:
            self.liveness.restart(now)
        path = self.paths.setdefault(digest.tag, PathDelays())
        if path.inbound.note(now, digest.sent, now):
            self.liveness.digest_received(now, path.inbound.last, paid_at)
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
        """The longest queue that stands for a `span` since then, before what comes here or what our receivers get."""
        recent = now - max(TUNING.recent_delays, 2.0 * self.liveness.interval(now))
        outward = [path for peer, path in self.paths.items() if not receivers or peer in receivers]
        directions = (
            [path.inbound for path in self.paths.values()],
            [path.outbound for path in outward],
            [path.link for path in outward],
        )
        found = [standing_queue(now, each, since, bearable / 2.0, recent=recent, span=span) for each in directions]
        return max((each for each in found if each), key=lambda each: each.delay, default=None)
