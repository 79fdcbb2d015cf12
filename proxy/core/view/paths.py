"""The ways of messages from robot to robot: how long they take, and how surely, as measured here or told."""

from collections.abc import Iterable
from typing import NamedTuple

from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import tag
from proxy.core.transit.latency import Latency, middle
from proxy.core.transit.outbound import share_of
from proxy.core.view.members import Members
from proxy.core.view.tuning import TUNING

Known = dict[str, tuple[Latency | None, float | None]]
"""What is known of ways, by the tags of the receivers: time and loss; None where it is not."""


class Way(NamedTuple):
    """The way of a message to one robot: it takes `latency` [s] and gets there with the chance `share`."""

    latency: float
    share: float = 1.0


class Fan:
    """What is known of the ways of a robot's samples, in the order of the receivers' tags, and their mean time."""

    def __init__(self, known: Known) -> None:
        self.mean = _mean(line for line, _ in known.values() if line is not None)
        self._known = sorted(known.items())

    @property
    def alike(self) -> "Fan":
        """The same, with the mean loss on all ways."""
        return Fan({name: (line, None) for name, (line, _) in self._known})

    def ways(self, gaining: tuple[str, ...], size: float, lost: float) -> list[Way]:
        """Return the ways of a sample of `size` [B] to those that gain by it; where unknown the mean time and loss."""
        names, share, mean = set(gaining), 1.0 - lost, self.mean.of(size)
        found = [
            Way(mean if line is None else line.of(size), share if loss is None else 1.0 - min(TUNING.most_loss, loss))
            for name, (line, loss) in self._known
            if name in names
        ]
        unknown = len(gaining) - len(found)
        return [*found, Way(mean, unknown * share)] if unknown else found


class Paths:
    """The ways between the robots that are here, and the loss on all of them."""

    def __init__(self, settings: CoreSettings, members: Members) -> None:
        self._own = settings.robot, tag(settings.zid)
        self._members = members

    def of(self, robot: str) -> Fan:
        """Return the ways of a robot's samples."""
        return Fan(self._from_us() if robot == self._own[0] else self._from(robot))

    def on_air(self, gaining: tuple[str, ...], size: float) -> float | None:
        """Return what samples of `size` [B] take beyond digests to those that gain by ours, as these tell [s].

        The median of what they tell of our samples, and a few of them of others'; None while they told of none.
        """
        senders = self._members.peers
        peers = [peer for name in gaining if (peer := senders.get(name)) is not None]
        lines = [(peer, peer.outbound.latency) for peer in peers]
        lines += [(peer, each.heard_by.get(peer.tag)) for peer in peers[: TUNING.told_by] for each in senders.values()]
        told = [max(0.0, line.of(size) - peer.offset.latency) for peer, line in lines if line is not None]
        return middle(told) if told else None

    def mean_loss(self) -> float:
        """Return the loss of all samples that went on ways that we know; 0.0 when we know none."""
        counted = [peer.counted_samples for peer in self._members.peers.values()]
        share = share_of(sum(sent for sent, _ in counted), sum(lost for _, lost in counted))
        return min(TUNING.most_loss, share or 0.0)

    def _from_us(self) -> Known:
        return {name: (peer.outbound.line, peer.outbound.losses.share) for name, peer in self._members.peers.items()}

    def _from(self, robot: str) -> Known:
        sender = self._members.called(robot)
        if sender is None:
            return {}
        heard = sender.heard_by
        known: Known = {name: (heard[name], None) for name in (self._members.peers if heard else ()) if name in heard}
        known[self._own[1]] = sender.inbound.line, sender.inbound.losses.share
        return known


def _mean(lines: Iterable[Latency]) -> Latency:
    known = list(lines)
    if not known:
        return Latency(0.0)
    return Latency(sum(each.fixed for each in known) / len(known), sum(each.per_byte for each in known) / len(known))
