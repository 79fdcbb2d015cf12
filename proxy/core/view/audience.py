"""The ways of messages from robot to robot, how long and how sure, and those that gain by a stream so."""

import math
from collections.abc import Iterable
from itertools import pairwise
from typing import NamedTuple, Self

from planner import Receiver
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import tag
from proxy.core.transit.latency import Latency, middle
from proxy.core.transit.outbound import share_of
from proxy.core.view.members import Members
from proxy.core.view.stream import Stream
from proxy.core.view.subscribers import Subscribers
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
        self.mean = _mean([line for line, _ in known.values() if line is not None])
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
        if robot != self._own[0]:
            return Fan(self._from(robot))
        return Fan({name: (p.outbound.line, p.outbound.losses.share) for name, p in self._members.peers.items()})

    def on_air(self, gaining: tuple[str, ...], size: float) -> float | None:
        """Return what samples of `size` [B] take beyond digests to those that gain by ours, by the median told [s]."""
        senders = self._members.peers
        peers = [(name, peer) for name in gaining if (peer := senders.get(name)) is not None]
        lines = [(peer, peer.outbound.latency) for _, peer in peers]
        lines += [
            (peer, each.heard_by.get(name)) for name, peer in peers[: TUNING.told_by] for each in senders.values()
        ]
        told = [max(0.0, line.of(size) - peer.offset.latency) for peer, line in lines if line is not None]
        return middle(told) if told else None

    def mean_loss(self) -> float:
        """Return the loss of all samples that went on ways that we know; 0.0 when we know none."""
        sent = lost = 0
        for peer in self._members.peers.values():
            (out, lost_out), (came, lost_in) = peer.outbound.losses.counted, peer.inbound.losses.counted
            sent, lost = sent + out + came, lost + lost_out + lost_in
        return min(TUNING.most_loss, share_of(sent, lost) or 0.0)

    def _from(self, robot: str) -> Known:
        sender = self._members.called(robot)
        if sender is None:
            return {}
        heard = sender.heard_by
        known: Known = {name: (heard[name], None) for name in (self._members.peers if heard else ()) if name in heard}
        known[self._own[1]] = sender.inbound.line, sender.inbound.losses.share
        return known


def _mean(lines: list[Latency]) -> Latency:
    fixed, per_byte = sum([each.fixed for each in lines]), sum([each.per_byte for each in lines])
    return Latency(fixed / len(lines), per_byte / len(lines)) if lines else Latency(0.0)


def grouped(known: Iterable[Way]) -> tuple[float, tuple[Receiver, ...]]:
    """Return the least latency [s], and the receivers with their shares and delays after it; there is a way."""
    ways = list(known)
    if len(ways) == 1:
        only = _joined(ways)
        return only.latency, (Receiver(0.0, only.share),)
    alike: dict[int, list[Way]] = {}
    for way in ways:
        alike.setdefault(round(way.latency / TUNING.alike_latency), []).append(way)
    groups = [_joined(each) for _, each in sorted(alike.items())]
    while len(groups) > TUNING.receiver_groups:
        groups = _with_nearest_joined(groups)
    least = groups[0].latency
    return least, tuple(Receiver(group.latency - least, group.share) for group in groups)


def _joined(ways: list[Way]) -> Way:
    """Return the mean way, by the shares, and the sum of the shares."""
    share = sum([way.share for way in ways])
    if share == 0.0:
        return Way(sum([way.latency for way in ways]) / len(ways), 0.0)
    return Way(sum([way.latency * way.share for way in ways]) / share, share)


def _with_nearest_joined(groups: list[Way]) -> list[Way]:
    gaps = [after.latency - before.latency for before, after in pairwise(groups)]
    at = gaps.index(min(gaps))
    return [*groups[:at], _joined(groups[at : at + 2]), *groups[at + 2 :]]


class Audience(NamedTuple):
    """Those that gain by a stream: `size` [B] take `latency` [s] to the first, every byte more `per_byte` [s/B].

    `share` is how many receivers there are, each counted by the chance that a message gets there. It takes `mean` to
    those whom it gets to, and to the last one `slowest` [s].
    """

    size: int
    latency: float
    per_byte: float
    receivers: tuple[Receiver, ...]
    share: float
    mean: float
    slowest: float

    @classmethod
    def of(cls, size: int, latency: float, per_byte: float, receivers: tuple[Receiver, ...]) -> Self:
        """Sum up these receivers, of whom there is one."""
        share, mean = sum([r.share for r in receivers]), latency
        if share > 0.0:
            mean += sum([r.delay * r.share for r in receivers]) / share
        return cls(size, latency, per_byte, receivers, share, mean, latency + max([r.delay for r in receivers]))

    def latency_of(self, size: int) -> float:
        """The time that a message of so many bytes takes to the first of the receivers [s]."""
        return max(0.0, self.latency + self.per_byte * (size - self.size))


def audience_of(fan: Fan, gaining: tuple[str, ...], size: int, lost: float) -> Audience:
    """Return those that gain by messages of `size` [B] which go such ways; `lost` is the mean loss."""
    first, receivers = grouped(fan.ways(gaining, size, lost) or [Way(fan.mean.of(size))])
    return Audience.of(size, first, fan.mean.per_byte, receivers)


class Audiences:
    """The audience of each stream, one for streams that are alike, looked at anew when it changes, and now and then."""

    def __init__(self, settings: CoreSettings, members: Members, subscribers: Subscribers, paths: Paths) -> None:
        self._settings = settings
        self._members = members
        self._subscribers = subscribers
        self._paths = paths
        self._known: dict[tuple[str, str], _Looked] = {}
        self._common: dict[tuple[str, int, tuple[str, ...]], _Looked] = {}
        self._lost, self._looked_at = 0.0, -math.inf
        self._fans: dict[str, Fan] = {}
        """The loss on all ways, and the ways of the robots that were asked for, when they were looked at last [s]."""
        self._alike = False
        """Whether as much is taken to be lost on all ways."""

    def take_alike(self, *, alike: bool) -> None:
        """Take as much to be lost on all ways, so that all robots know the same, or what is known of each.

        Where all plans have to be the same ten robots had 6.5 to 9.4 % of the windows over, and have 0 to 1 (10 %
        lost).
        """
        if alike != self._alike:
            self._alike = alike
            self._known.clear()
            self._common.clear()

    def of(self, now: float, stream: Stream) -> Audience:
        """Return those that gain by each message of a stream as they are now."""
        gaining, place = self._subscribers.gaining(stream), (stream.robot, stream.key)
        known = self._known.get(place)
        if known is None or now >= known.until or not (gaining is known.gaining or gaining == known.gaining):
            if len(self._known) > self._settings.streams:
                self._known.clear()
            known = self._known[place] = self._look(now, stream, gaining)
        return known.audience

    def among(self, now: float, stream: Stream, names: tuple[str, ...]) -> Audience:
        """Return the same for the robots with these tags, whether they gain or not."""
        return self._look(now, stream, names).audience

    def to(self, name: str, size: int) -> Audience:
        """Return the robot with this tag as the only one that gains by a message of ours of so many bytes."""
        return audience_of(self._paths.of(self._settings.robot), (name,), size, self._paths.mean_loss())

    def _look(self, now: float, stream: Stream, gaining: tuple[str, ...]) -> "_Looked":
        """Look at the ways of a stream, unless those of another stream that are the same were looked at lately."""
        size = _about(stream.newest.size)
        found = self._common.get((stream.robot, size, gaining))
        if found is None or now >= found.until:
            if len(self._common) > self._settings.streams:
                self._common.clear()
            if now != self._looked_at:
                self._looked_at, self._lost, self._fans = now, self._paths.mean_loss(), {}
            fan = self._fans.get(stream.robot) or self._fans.setdefault(stream.robot, self._paths.of(stream.robot))
            audience = audience_of(fan.alike if self._alike else fan, gaining, size, self._lost)
            until = now + TUNING.ways_refresh * max(1.0, len(self._members.peers) / TUNING.small_team)
            found = _Looked(until, gaining, audience)
            self._common[stream.robot, size, gaining] = found
        return found


def _about(size: int) -> int:
    """Return the nearest size that has no more than so many binary digits that are not 0 at its end [B]."""
    unit = 1 << max(0, size.bit_length() - TUNING.size_digits)
    return (size + unit // 2) // unit * unit


class _Looked(NamedTuple):
    """An audience, of those that were `gaining`, as it is taken to be `until` then [s]."""

    until: float
    gaining: tuple[str, ...]
    audience: Audience
