"""The ways of messages from robot to robot, as far as this robot knows: how long they take, and how surely.

Our own we measure or are told; those between two others are told by the one that receives.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from proxy.core.receivers import Way
from proxy.core.stream import Stream
from proxy.core.wire import tag

if TYPE_CHECKING:
    from proxy.core.view import SharedView

MOST_LOSS = 0.95
"""A robot that gets less than the rest of our samples is not given up: it may get better."""


def ways(view: SharedView, stream: Stream, size: float) -> list[Way]:
    """Return the ways of a sample of `size` [B] to each of those that gain by a stream."""
    gaining = view.gaining(stream)
    if not gaining:
        return []
    mean = Way(latency(view, stream.robot, size), 1.0 - mean_loss(view))
    return [_known(view, stream.robot, name, size).filled(mean) for name in gaining]


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


def _known(view: SharedView, robot: str, name: str, size: float) -> _Known:
    """Return what is known of the way of a robot's samples to the one with the tag `name`, which may be us."""
    receiver, sender = view.peers.get(name), view.peer_called(robot)
    if robot == view.settings.robot:
        return _Known(None, None) if receiver is None else _Known(receiver.latency_to(size), receiver.loss_out)
    if sender is None:
        return _Known(None, None)
    if receiver is None:
        return _Known(sender.latency_from(size), sender.loss_in)
    line = receiver.hears.get(tag(sender.zid))
    return _Known(None if line is None else line.of(size), None)
