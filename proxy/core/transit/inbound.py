"""How the samples and digests of another robot come to us: how long they take, and how many get lost."""

from collections import deque
from dataclasses import dataclass, field
from typing import NamedTuple

from proxy.core.protocol.messages import StreamDigest
from proxy.core.transit.latency import Latency, LatencyFit, far_quicker, middle
from proxy.core.transit.offset import ClockOffset
from proxy.core.transit.outbound import Loss
from proxy.core.transit.tuning import TUNING


@dataclass(slots=True)
class Incoming:
    """How the samples of one stream of a peer come in."""

    heard: int = 0
    """Samples received."""
    stamp: float = -1.0
    """Timestamp of the last one [s, its robot's wall clock]; -1.0: it had none."""
    at: float = 0.0
    """When it came [s]."""
    size: int = 0
    astray: bool = False
    """Whether its timestamps are of another clock than its robot's."""
    waits: deque[float] = field(default_factory=lambda: deque(maxlen=TUNING.waits))
    """How long samples waited to be sent [s], as far as digests tell."""
    sent: tuple[int, float] = (0, 0.0)
    """Number of the last sample of which news tell when it was generated, and when that was [s, its robot's clock]."""
    counted: tuple[int, int] | None = None
    """Samples sent by the last news that counted, and those received then."""

    def hear(self, now: float, size: int, stamp: float | None) -> float:
        """A sample came; return how long samples wait to be sent [s]."""
        self.heard += 1
        self.at, self.size = now, size
        self.stamp = -1.0 if stamp is None else stamp
        return middle(self.waits) if self.waits else 0.0

    def note(self, news: StreamDigest) -> None:
        """News tell when the last sample sent was generated, unless a later one was generated since."""
        if news.t_forwarded >= news.t_generated:
            self.sent = news.forwarded, news.t_generated

    def count(self, sent: int) -> None:
        """The robot sent so many; what has been received by now is among them."""
        self.counted = sent, self.heard

    def restart(self) -> None:
        """Forget the counts: from now on other samples are counted."""
        self.counted = None

    def judge(self, news: StreamDigest, wall_offset: float) -> None:
        """Find from news of the last sample whether timestamps are of the robot's wall clock, and it goes by them."""
        stamp, (number, generated) = self.stamp - wall_offset, self.sent
        if number == news.forwarded:
            self.astray = abs(generated - stamp) > TUNING.unheeded_timestamp
        else:
            self.astray = abs(news.t_forwarded - stamp) > TUNING.timestamp_mismatch + news.period


class _Heard(NamedTuple):
    """A sample that came at `at` [s], and should have been sent when its robot's wall clock showed `shown`."""

    at: float
    size: int
    shown: float
    stream: Incoming


class Inbound:
    """What samples of a robot take to us, by their timestamps, and the loss among them; `offset` is of its clock."""

    def __init__(self, offset: ClockOffset) -> None:
        self._offset = offset
        self.samples = 0
        self.implausible = 0
        """Those whose timestamp could not be right."""
        self.evicted = 0
        """Streams that there was no room for."""
        self.wall_offset: float | None = None
        """The robot's wall clock minus its monotonic clock [s]; None until it said."""
        self._streams: dict[str, Incoming] = {}
        self._unread: deque[_Heard] = deque(maxlen=TUNING.unread_timestamps)
        self._samples = LatencyFit()
        self._digests = LatencyFit()
        self.losses = Loss()
        self._sent, self._came = 0, 0
        """Samples of all streams that were sent to us, and those of them that came."""
        self._last: tuple[float, int] = (0.0, 0)
        """When the last sample came [s], and its size [B]."""
        self._period = 0.0
        """The longest time between two that came lately [s]."""
        self._usual: Latency | None = None
        self._usual_until = 0.0

    @property
    def latency(self) -> Latency | None:
        """What samples take to us; as long as too few came, digests; None while unknown."""
        return self._samples.line or self._digests.line

    @property
    def line(self) -> Latency | None:
        """What samples take to us; while that is unknown, half of what digests take there and back."""
        return self.latency or self._offset.line

    def heard_sample(self, now: float, key: str, size: int, stamp: float | None) -> tuple[float, float] | None:
        """A sample arrived; `stamp` is on its robot's wall clock [s].

        Return when it was generated and sent, on our clock [s], by what samples take and wait; None: not known.
        """
        self.samples += 1
        if self._last[1]:
            self._period = max(now - self._last[0], TUNING.gap_fade * self._period)
        self._last = now, size
        incoming = self._of(key)
        before, wait = incoming.stamp, incoming.hear(now, size, stamp)
        if stamp is not None and self.wall_offset is not None and self._offset.known:
            if abs(stamp - before) < TUNING.same_time:
                self.implausible += 1
            else:
                if len(self._unread) == TUNING.unread_timestamps:
                    self._read(self._unread[0].at)
                self._unread.append(_Heard(now, size, stamp + wait, incoming))
        self._read(now - TUNING.wall_step_told_within)
        line = self._usually(now)
        if line is None:
            return None
        sent = now - line.of(size)
        return sent - wait, sent

    def later(self, key: str, stamp: float | None, forwarded: int) -> float | None:
        """Return how much later a sample was generated than the last one that news tell of, number `forwarded` [s].

        By its `stamp`, on its robot's wall clock [s]; None where that says nothing.
        """
        incoming = self._streams.get(key)
        if stamp is None or self.wall_offset is None or incoming is None or incoming.astray:
            return None
        number, generated = incoming.sent
        later = stamp - self.wall_offset - generated
        return later if number == forwarded and abs(later) < TUNING.timestamp_mismatch else None

    def heard_news(self, now: float, key: str, news: StreamDigest, *, counts: bool) -> None:
        """The robot tells of a stream. The news `counts` if each sample is for us and those it tells of have come.

        But for the last one, which may be on its way: else of ten robots two sent a fifth of what one should (100 ms).
        """
        incoming = self._of(key)
        before, heard = incoming.counted, incoming.heard
        incoming.note(news)
        if not counts:
            incoming.restart()
        else:
            sent = news.forwarded - self._under_way(now, incoming, news)
            incoming.count(sent)
            if before is not None and sent >= before[0]:
                self._count(sent - before[0], heard - before[1])
                if news.forwarded - before[0] == heard - before[1] > 0:
                    self._compare(incoming, news)
        wait = news.t_forwarded - news.t_generated
        if (before is None or news.forwarded > before[0]) and 0.0 <= wait < max(TUNING.longest_wait, news.period):
            incoming.waits.append(wait)

    def heard_digest(self, now: float, sent: float, size: int) -> None:
        """A digest that was sent at `sent`, on its robot's clock, is an example of what messages take."""
        if self._offset.known:
            self._digests.observe(now, size, max(0.0, now - self._offset.ours(sent)))

    def forget_queue(self, now: float) -> None:
        """Forget what samples took in a queue when none came lately and digests are quicker: nobody would send."""
        at, size = self._last
        if not self._offset.known or now < at + max(TUNING.unconfirmed_for, TUNING.unconfirmed_gaps * self._period):
            return
        line = self._samples.line
        if line is not None and far_quicker(self._offset.latency, line.of(size)):
            self._samples = LatencyFit()
            self._unread.clear()

    def set_wall_offset(self, now: float, offset: float) -> None:
        """The robot's wall clock shows so much more than its monotonic one; it was set when it shows something else."""
        before = self.wall_offset
        if before is None or abs(before - offset) <= TUNING.wall_clock_set:
            self.wall_offset = offset
            return
        self._read(now - TUNING.wall_step_told_within)
        self.wall_offset = offset
        self._read(now, before)

    def restart_losses(self) -> None:
        """Forget the counts: from now on the other robot counts other samples than we do."""
        self.losses.restart()
        for incoming in self._streams.values():
            incoming.restart()

    def _count(self, sent: int, came: int) -> None:
        if not self.losses.begun:
            self.losses.read(self._sent, self._came)
        self._sent += sent
        self._came += came
        self.losses.read(self._sent, self._came)

    def _under_way(self, now: float, incoming: Incoming, news: StreamDigest) -> bool:
        """Whether the last sample that a robot sent has not come, and may come yet."""
        sent = self._offset.ours(news.t_forwarded)
        if not news.forwarded or incoming.at >= sent:
            return False
        line = self._usually(now)
        return now < sent + (TUNING.slow_sample * line.of(news.size) if line else TUNING.oldest_arrival)

    def _compare(self, incoming: Incoming, news: StreamDigest) -> None:
        """All samples that were sent came, so the news tells when the last one was, and if its timestamp is astray."""
        if incoming.stamp < 0.0 or self.wall_offset is None or not self._offset.known:
            return
        incoming.judge(news, self.wall_offset)
        line, took = self._samples.line, incoming.at - self._offset.ours(news.t_forwarded)
        if incoming.astray and line is not None and line.of(incoming.size) > took + TUNING.unheeded_timestamp:
            self._samples = LatencyFit()

    def _read(self, until: float, *others: float) -> None:
        """Read the timestamps of samples that came until then, by the likeliest of the wall clock's offsets."""
        while self._unread and self._unread[0].at <= until:
            heard = self._unread.popleft()
            took = None if heard.stream.astray else self._took(heard, self.wall_offset)
            for offset in () if heard.stream.astray else others:
                took = self._likelier(heard, self._took(heard, offset), took)
            if took is None:
                self.implausible += 1
            else:
                self._samples.observe(heard.at, heard.size, took)

    def _took(self, heard: _Heard, wall_offset: float | None) -> float | None:
        """The time from sending to receipt of a sample [s]; None when it cannot be right."""
        if wall_offset is None:
            return None
        parts = TUNING.parts_of_a_second
        took = round(parts * (heard.at - self._offset.ours(heard.shown - wall_offset))) / parts
        if took >= 0.0:
            return took if took < TUNING.oldest_arrival else None
        return 0.0 if took >= -TUNING.earliest_arrival - self._offset.uncertainty(heard.at) else None

    def _likelier(self, heard: _Heard, one: float | None, other: float | None) -> float | None:
        """Of two times that a sample may have taken the one that is nearer to what they usually take [s]."""
        if one is None or other is None:
            return other if one is None else one
        line = self._usually(heard.at)
        usual = line.of(heard.size) if line else 0.0
        return one if abs(one - usual) <= abs(other - usual) else other

    def _usually(self, now: float) -> Latency | None:
        """What samples take to us, looked at anew now and then."""
        if self._usual is None or now >= self._usual_until:
            self._usual, self._usual_until = self.line, now + TUNING.latency_refresh
        return self._usual

    def _of(self, key: str) -> Incoming:
        """Return how a stream comes in; if there are too many, the one not heard of for longest is forgotten."""
        found = self._streams.pop(key, None) or Incoming()
        if len(self._streams) >= TUNING.streams:
            del self._streams[next(iter(self._streams))]
            self.evicted += 1
        self._streams[key] = found
        return found
