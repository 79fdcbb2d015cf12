"""What samples tell that are overheard: what was sent, before the digest of their robot tells it."""

import math

from proxy.core.interface.events import SampleHeard
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.tuning import TUNING as PROTOCOL
from proxy.core.view.members import Members
from proxy.core.view.peer import Peer
from proxy.core.view.stream import Generated, Sent, Stream
from proxy.core.view.streams import PLAIN, Streams
from proxy.core.view.traffic import TrafficLog
from proxy.core.view.tuning import TUNING


class Origins:
    """The origins of each robot; `evicted` counts those of ours that had to be forgotten."""

    def __init__(self, settings: CoreSettings, streams: Streams, members: Members) -> None:
        self._settings = settings
        self._streams = streams
        self._members = members
        self.own: dict[str, None] = {settings.zid: None}
        """Ids of samples that entered on our app side, the one seen first longest ago first."""
        self.evicted = 0
        self._robots: dict[str, str] = {}
        """Robots by the origins they claim."""
        self._parted: dict[str, float] = {}
        """Origins of robots that left, with the times at which they did [s], the first one first."""

    def robot_of(self, origin: str | None) -> str:
        """The robot whose app side an origin entered; an unknown origin is a provisional plain node."""
        if origin is None or origin in self.own:
            return self._settings.robot
        return self._robots.get(origin) or f"{PLAIN}{origin}"

    def tag_of(self, origin: str) -> str:
        """The tag of the robot that claims an origin; empty: nobody does. From any thread."""
        return self._members.tags.get(self._robots.get(origin, ""), "")

    def claim(self, origin: str | None) -> bool:
        """A sample with this origin entered our app side; True when that made it newly ours."""
        if origin is None or origin in self.own or not self.robot_of(origin).startswith(PLAIN):
            return False
        for stream in self._streams.of(f"{PLAIN}{origin}"):
            self._streams.forget(stream)
        if len(self.own) >= PROTOCOL.origins:
            self.evicted += 1
            self.own.pop(next(o for o in self.own if o != self._settings.zid))
        self.own[origin] = None
        return True

    def part(self, now: float, peer: Peer) -> None:
        """A robot left; samples of its that are on their way are nobody else's."""
        for origin in (peer.zid, *peer.state.origins):
            self._parted.pop(origin, None)
            self._parted[origin] = now
        while len(self._parted) > PROTOCOL.origins:
            del self._parted[next(iter(self._parted))]

    def parted(self, now: float, origin: str | None) -> bool:
        """Whether a sample of this origin, which is nobody's, is likely to be of a robot that has just left."""
        return origin is not None and now < self._parted.get(origin, -math.inf) + TUNING.parting_time

    def assign(self) -> None:
        """Give each origin to the robot that claimed it first, or whose own id it is; streams of plain nodes follow."""
        peers = self._members.peers
        ids = {peer.zid: peer.robot for peer in peers.values()}
        claimed = {origin: peer.robot for peer in reversed(list(peers.values())) for origin in peer.state.origins}
        self._robots = claimed | ids
        self._streams.revise()
        for stream in self._streams.plain():
            robot = self._robots.get(stream.robot.removeprefix(PLAIN))
            if robot is not None:
                self._streams.hand_over(stream, robot)


class Overhearing:
    """Takes in the samples of other robots that arrive from the mesh."""

    def __init__(self, streams: Streams, members: Members, origins: Origins, traffic: TrafficLog) -> None:
        self._streams = streams
        self._members = members
        self._origins = origins
        self._traffic = traffic

    def take(self, event: SampleHeard) -> None:
        """A sample of another robot arrived from the mesh."""
        now = event.now
        # Daemons stamp all that they send.
        robot = PLAIN if event.origin is None else self._origins.robot_of(event.origin)
        peer = self._members.called(robot)
        if peer is not None and peer.plain:
            peer, robot = None, f"{PLAIN}{event.origin}"
        if peer is not None and peer.digest is not None:
            self._take_from(now, peer.inbound.heard_sample(now, event.key, event.size, event.stamp), event, peer)
        elif peer is not None:
            peer.hear_sample()
            self._traffic.note_unknown(now, event.size, peer.robot)
        elif self._origins.parted(now, event.origin):
            self._traffic.note_unknown(now, event.size, robot)
        elif robot.startswith(PLAIN) and (stream := self._streams.touch(now, robot, event.key)) is not None:
            features = event.features or {}
            scale = stream.information_type.scale(features)
            generated = Generated(now, event.size, scale, features)
            stream.note_generated(stream.generated + 1, generated)
            self._traffic.note_sent(stream, stream.forwarded + 1, Sent(now, now, event.size, scale, features))

    def _take_from(self, now: float, times: tuple[float, float] | None, event: SampleHeard, peer: Peer) -> None:
        """A sample of a robot we know was sent at these `times`, generated and sent, which a digest may tell of."""
        stream, t_gen = self._streams.known(peer.robot, event.key), None if times is None else times[0]
        if stream is None or stream.last is None:
            stream = self._meet(now, t_gen, event, peer)
        if stream is None or stream.last is None:
            self._traffic.note_unknown(now, event.size, peer.robot, planned=False)
            return
        # No sample is quicker than the quickest digest: rather later than earlier, or its window seems to be over.
        on_air = now - peer.offset.latency + TUNING.same_sample
        t_gen, t_left = (on_air, on_air) if times is None else (min(times[0], now), times[1])
        later = peer.inbound.later(event.key, event.stamp, stream.forwarded)
        if stream.sent is not None and _counted(stream, stream.sent, event.size, later, (t_left, on_air)):
            return
        features = event.features or {}
        scale = stream.information_type.scale(features) if features else stream.last.scale
        t_sent = max(t_gen, on_air)
        self._traffic.note_sent(stream, stream.forwarded + 1, Sent(t_gen, t_sent, event.size, scale, features))
        # Its number only the digest tells that follows: a wrong one would spoil the schedule, and hide the right one.
        if t_gen > stream.last.t_gen:
            stream.renew(Generated(t_gen, event.size, scale, features or stream.last.features))

    def _meet(self, now: float, t_gen: float | None, event: SampleHeard, peer: Peer) -> Stream | None:
        """A sample of a stream was overheard of which no digest has told yet; None where no spec plans for it.

        Each of fifty robots knew 100 of 250 streams after 8 s without it, and 60 % of the windows were over the limit.
        """
        stream = self._streams.touch(now, peer.robot, event.key)
        if stream is None:
            return None
        if (told := peer.told.get(event.key)) is not None:
            stream.assume(told)
        features, at = event.features or {}, now if t_gen is None else min(t_gen, now)
        last = Generated(at, event.size, stream.information_type.scale(features), features)
        stream.note_generated(1, last, overheard=True)
        return stream


def _counted(stream: Stream, sent: Sent, size: int, later: float | None, left: tuple[float, float]) -> bool:
    """Whether a sample of `size` [B] that we hear is counted already: as what the stream `sent` last, or before that.

    It is if it was generated no `later` than that, as its timestamp and the news say: by what samples take frames of
    three robots counted twice that took 160 ms, which hid what was announced next (11 % of the windows were over). If
    it seems to be later clocks may run ahead. Then it is told by when it `left` its robot, as samples take and at the
    latest [s], for waits differ: else six robots did not count every tenth sample of others.
    """
    t_left, on_air = left
    if not sent.told:
        return on_air < sent.t_sent + TUNING.same_sample
    if later is not None and later <= TUNING.same_stamp:
        if later >= -TUNING.same_stamp:
            stream.hear_told()
        return True
    apart, alike = TUNING.told_sample * stream.period, TUNING.same_size if size == sent.size else TUNING.same_sample
    if t_left >= sent.t_sent + max(apart, alike):
        return False
    if t_left > sent.t_sent - apart:  # else it is an older one, and that one is still to come
        stream.hear_told()
    return True
