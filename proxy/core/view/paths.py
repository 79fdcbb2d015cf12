"""The ways of messages from robot to robot, as far as this robot knows: how long they take, and how surely.

Our own we measure or are told; those between two others are told by the one that receives.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from planner import Receiver
from proxy.core.protocol.messages import tag
from proxy.core.view.latency import Latency
from proxy.core.view.loss import share_of
from proxy.core.view.receivers import Way, grouped
from proxy.core.view.stream import Stream

if TYPE_CHECKING:
    from proxy.core.view.view import SharedView

REFRESH = 0.2
"""What ways are like is looked at anew this often [s]."""
MANY = 10
"""Robots that are no large team."""
MOST_LOSS = 0.95
"""A robot that gets less than the rest of our samples is not given up: it may get better."""


def ways(view: SharedView, stream: Stream, size: float, lost: float | None = None) -> list[Way]:
    """Return the ways of a sample of `size` [B] to those that gain by a stream; `lost` is the mean loss, if known.

    Those of which nothing is known are one way, with the sum of their shares.
    """
    return _From(view, stream.robot).ways(view.gaining(stream), size, mean_loss(view) if lost is None else lost)


def latency(view: SharedView, robot: str, size: float) -> float:
    """Return the mean time from sending to receipt of a robot's samples of `size` [s]; 0.0 when nothing is known."""
    return line(view, robot).of(size)


def line(view: SharedView, robot: str) -> Latency:
    """Return what a robot's samples take, in the mean of its ways; nothing when nothing is known."""
    return _From(view, robot).mean


def mean_loss(view: SharedView) -> float:
    """Return the loss of all samples that went on ways that we know; 0.0 when we know none."""
    counted = [peer.counted_samples for peer in view.peers.values()]
    share = share_of(sum(sent for sent, _ in counted), sum(lost for _, lost in counted))
    return min(MOST_LOSS, share or 0.0)


_Known = Mapping[str, tuple[Latency | None, float | None]]
"""What is known of ways, by the tags of the receivers: time and loss; None where it is not."""


class _From:
    """What is known of the ways of a robot's samples, in the order of the tags, and the mean time they take."""

    def __init__(self, view: SharedView, robot: str) -> None:
        known = _known_from_us(view) if robot == view.settings.robot else _known_from(view, robot)
        self.mean = _mean(line for line, _ in known.values() if line is not None)
        self._known = sorted(known.items())

    def ways(self, gaining: tuple[str, ...], size: float, lost: float) -> list[Way]:
        """Return the ways of a sample of `size` [B] to those that gain by it; what is not known is as in the mean."""
        names, share, mean = set(gaining), 1.0 - lost, self.mean.of(size)
        found = [
            Way(mean if line is None else line.of(size), share if loss is None else 1.0 - min(MOST_LOSS, loss))
            for name, (line, loss) in self._known
            if name in names
        ]
        unknown = len(gaining) - len(found)
        return [*found, Way(mean, unknown * share)] if unknown else found


def _known_from_us(view: SharedView) -> _Known:
    return {name: (peer.line_out, peer.loss_out) for name, peer in view.peers.items()}


def _known_from(view: SharedView, robot: str) -> _Known:
    """Return what is known of the ways of another robot's samples."""
    sender = view.peer_called(robot)
    if sender is None:
        return {}
    heard = sender.heard_by
    known: dict[str, tuple[Latency | None, float | None]] = {
        name: (heard[name], None) for name in (view.peers if heard else ()) if name in heard
    }
    known[tag(view.settings.zid)] = sender.line_in, sender.loss_in
    return known


def _mean(lines: Iterable[Latency]) -> Latency:
    known = list(lines)
    if not known:
        return Latency(0.0)
    return Latency(sum(each.fixed for each in known) / len(known), sum(each.per_byte for each in known) / len(known))


@dataclass(frozen=True, slots=True)
class Audience:
    """Those that gain by a stream: a message of `size` [B] takes `latency` [s] to the first of the `receivers`.

    Every byte more adds `per_byte` [s/B].
    """

    size: int
    latency: float
    per_byte: float
    receivers: tuple[Receiver, ...]

    def latency_of(self, size: int) -> float:
        """The time that a message of so many bytes takes to the first of the receivers [s]."""
        return max(0.0, self.latency + self.per_byte * (size - self.size))

    @property
    def share(self) -> float:
        """How many they are, as far as messages get to them."""
        return sum([r.share for r in self.receivers])

    @property
    def mean(self) -> float:
        """The mean time to those whom messages get to [s]."""
        return self.latency + sum(r.delay * r.share for r in self.receivers) / self.share

    @property
    def slowest(self) -> float:
        """The time to the last of the receivers [s]."""
        return self.latency + max(r.delay for r in self.receivers)


class Audiences:
    """The audience of each stream, looked at anew when somebody joins or leaves it, and every `REFRESH`.

    In large teams that is more work, and done more rarely: every `REFRESH` for every `MANY` robots. Streams of one
    robot whose samples are of one size, and which the same robots want, have one audience.
    """

    def __init__(self, view: SharedView) -> None:
        self._view = view
        self._known: dict[tuple[str, str], _Looked] = {}
        self._common: dict[tuple[str, int, tuple[str, ...]], _Looked] = {}
        self._lost, self._lost_at = 0.0, -math.inf

    def of(self, now: float, stream: Stream) -> Audience:
        """Return those that gain by each message of a stream as they are now."""
        gaining, place = self._view.gaining(stream), (stream.robot, stream.key)
        known = self._known.get(place)
        if known is None or now >= known.until or not (gaining is known.gaining or gaining == known.gaining):
            if len(self._known) > self._view.settings.streams:
                self._known.clear()
            known = self._known[place] = self._look(now, stream, gaining)
        return known.audience

    def to(self, now: float, name: str, size: int) -> Audience:
        """Return the robot with this tag as the only one that gains by a message of ours of so many bytes."""
        sender = _From(self._view, self._view.settings.robot)
        first, receivers = grouped(sender.ways((name,), size, self._loss(now)))
        return Audience(size, first, sender.mean.per_byte, receivers)

    def _look(self, now: float, stream: Stream, gaining: tuple[str, ...]) -> _Looked:
        """Look at the ways of a stream, or find what they were for another one lately."""
        size = stream.newest.size
        found = self._common.get((stream.robot, size, gaining))
        if found is None or now >= found.until:
            if len(self._common) > self._view.settings.streams:
                self._common.clear()
            lost, sender = self._loss(now), _From(self._view, stream.robot)
            ways = sender.ways(gaining, size, lost)
            first, receivers = grouped(ways or [Way(sender.mean.of(size))])
            until = now + REFRESH * max(1.0, len(self._view.peers) / MANY)
            found = _Looked(until, gaining, Audience(size, first, sender.mean.per_byte, receivers))
            self._common[stream.robot, size, gaining] = found
        return found

    def _loss(self, now: float) -> float:
        """The mean loss, looked at anew when time passed."""
        if now != self._lost_at:
            self._lost, self._lost_at = mean_loss(self._view), now
        return self._lost


@dataclass(frozen=True, slots=True)
class _Looked:
    """An audience, of those that were `gaining`, as it is taken to be `until` then [s]."""

    until: float
    gaining: tuple[str, ...]
    audience: Audience
