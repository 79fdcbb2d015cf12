"""The ways of messages from robot to robot, as far as this robot knows: how long they take, and how surely.

Our own we measure or are told; those between two others are told by the one that receives.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from planner import Receiver
from proxy.core.receivers import Way, grouped
from proxy.core.stream import Stream
from proxy.core.wire import tag

if TYPE_CHECKING:
    from proxy.core.peer import Peer
    from proxy.core.view import SharedView

REFRESH = 0.2
"""What ways are like is looked at anew this often [s]."""
MOST_LOSS = 0.95
"""A robot that gets less than the rest of our samples is not given up: it may get better."""


def ways(view: SharedView, stream: Stream, size: float) -> list[Way]:
    """Return the ways of a sample of `size` [B] to each of those that gain by a stream."""
    gaining = view.gaining(stream)
    if not gaining:
        return []
    mean = Way(latency(view, stream.robot, size), 1.0 - mean_loss(view))
    sender = None if stream.robot == view.settings.robot else view.peer_called(stream.robot)
    ours = tag(view.settings.zid)
    return [
        _known_from_us(view.peers.get(name), size).filled(mean)
        if stream.robot == view.settings.robot
        else _known_from(sender, None if name == ours else view.peers.get(name), size).filled(mean)
        for name in gaining
    ]


def latency(view: SharedView, robot: str, size: float) -> float:
    """Return the mean time from sending to receipt of a robot's samples of `size` [s]; 0.0 when nothing is known."""
    if robot == view.settings.robot:
        known = [took for peer in view.peers.values() if (took := peer.latency_to(size)) is not None]
    else:
        sender = view.peer_called(robot)
        if sender is None:
            return 0.0
        told = [peer.hears.get(tag(sender.zid)) for peer in view.peers.values()]
        all_ways = [sender.latency_from(size), *(None if line is None else line.of(size) for line in told)]
        known = [took for took in all_ways if took is not None]
    return sum(known) / len(known) if known else 0.0


def per_byte(view: SharedView, robot: str) -> float:
    """Return what every byte of a robot's samples adds to their latency [s/B], in the mean."""
    return latency(view, robot, 1.0) - latency(view, robot, 0.0)


def mean_loss(view: SharedView) -> float:
    """Return the mean loss of the ways that we know; 0.0 when we know none."""
    peers = view.peers.values()
    known = [loss for peer in peers for loss in (peer.loss_out, peer.loss_in) if loss is not None]
    return min(MOST_LOSS, sum(known) / len(known)) if known else 0.0


@dataclass(frozen=True, slots=True)
class _Known:
    """What is known of a way: time [s] and loss; None while it is not."""

    took: float | None
    lost: float | None

    def filled(self, mean: Way) -> Way:
        """Return the way, as `mean` where nothing better is known."""
        share = mean.share if self.lost is None else 1.0 - min(MOST_LOSS, self.lost)
        return Way(mean.latency if self.took is None else self.took, share)


_UNKNOWN = _Known(None, None)


def _known_from_us(receiver: Peer | None, size: float) -> _Known:
    """Return what is known of the way of our samples to a robot; to a plain node there is None."""
    return _UNKNOWN if receiver is None else _Known(receiver.latency_to(size), receiver.loss_out)


def _known_from(sender: Peer | None, receiver: Peer | None, size: float) -> _Known:
    """Return what is known of the way of another robot's samples, to us where the receiver is None."""
    if sender is None:
        return _UNKNOWN
    if receiver is None:
        return _Known(sender.latency_from(size), sender.loss_in)
    line = receiver.hears.get(tag(sender.zid))
    return _UNKNOWN if line is None else _Known(line.of(size), None)


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
        return sum(r.share for r in self.receivers)

    @property
    def mean(self) -> float:
        """The mean time to those whom messages get to [s]."""
        return self.latency + sum(r.delay * r.share for r in self.receivers) / self.share

    @property
    def slowest(self) -> float:
        """The time to the last of the receivers [s]."""
        return self.latency + max(r.delay for r in self.receivers)


class Audiences:
    """The audience of each stream, looked at anew when somebody joins or leaves it, and every `REFRESH`."""

    def __init__(self, view: SharedView) -> None:
        self._view = view
        self._known: dict[tuple[str, str], tuple[float, tuple[str, ...], Audience]] = {}

    def of(self, now: float, stream: Stream) -> Audience:
        """Return those that gain by a stream as they are now."""
        gaining, place = self._view.gaining(stream), (stream.robot, stream.key)
        known = self._known.get(place)
        if known is not None and now < known[0] and gaining == known[1]:
            return known[2]
        if len(self._known) > self._view.settings.streams:
            self._known.clear()
        audience = _audience(self._view, stream)
        self._known[place] = now + REFRESH, gaining, audience
        return audience


def _audience(view: SharedView, stream: Stream) -> Audience:
    size = stream.newest.size
    mean = Way(latency(view, stream.robot, size))
    first, receivers = grouped(ways(view, stream, size) or [mean])
    return Audience(size, first, per_byte(view, stream.robot), receivers)
