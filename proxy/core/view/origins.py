"""Whose samples are whose: by the id in a sample's timestamp, which is that of the session where it entered."""

from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.tuning import TUNING
from proxy.core.view.members import Members
from proxy.core.view.streams import PLAIN, Streams


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
        if len(self.own) >= TUNING.origins:
            self.evicted += 1
            self.own.pop(next(o for o in self.own if o != self._settings.zid))
        self.own[origin] = None
        return True

    def assign(self) -> None:
        """Give each origin to the robot that claimed it first, or whose own id it is; streams of plain nodes follow."""
        peers = self._members.peers
        ids = {peer.zid: peer.robot for peer in peers.values()}
        claimed = {origin: peer.robot for peer in reversed(list(peers.values())) for origin in peer.origins}
        self._robots = claimed | ids
        self._streams.revise()
        for stream in self._streams.plain():
            robot = self._robots.get(stream.robot.removeprefix(PLAIN))
            if robot is not None:
                self._streams.hand_over(stream, robot)
