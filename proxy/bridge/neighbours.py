"""Other daemons on our app side: where they are, the apps of several robots are joined around the daemons.

That happens where the routers of an installation are linked with each other. Were all daemons to bridge such apps, each
sample would arrive several times, and some would go round for ever. So one of them does it for all; the others stand
aside for as long as they see it.
"""

import threading
from collections.abc import Callable

import zenoh

from proxy.bridge import keys
from proxy.bridge.declaration import Declaration

MESHED = (
    "the router on the app side has a link to the mesh around the daemon, so nothing is decided upon: connect that "
    "router to the daemon only"
)
JOINED = (
    "the router on the app side has a link to robot {robot} around the daemons: what crosses it is not decided upon, "
    "and {who} bridges for both; let the routers of robots connect to their own daemons only"
)

REACHED = (
    "the router on the app side has a link to the daemon of robot {robot}, as if it were a robot: samples may arrive "
    "there twice; let the routers of robots connect to their own daemons only"
)


class Neighbours:
    """Says on the app side that this daemon is there, and follows who else is. `changed` is called when that changes.

    `own` is our mesh session's id: it on the app side means that the apps are on the mesh themselves.
    """

    def __init__(self, app: zenoh.Session, robot: str, own: str, changed: Callable[[], None]) -> None:
        self._zid = str(app.zid())
        self._robot = robot
        self._mesh = own
        self._changed = changed
        self._lock = threading.Lock()
        self._robots: dict[str, str] = {}
        self._reached: dict[str, str] = {}
        self._meshed = False
        handler = zenoh.handlers.Callback(self._notice, indirect=False)
        self._declared: list[Declaration] = [
            app.liveliness().declare_token(keys.at_apps(robot, self._zid)),
            app.liveliness().declare_subscriber(keys.ALL_AT_APPS, handler, history=True),
            app.liveliness().declare_subscriber(keys.ALL_ALIVE, handler, history=True),
        ]

    @property
    def aside(self) -> bool:
        """Whether another daemon bridges our apps, or nobody has to."""
        return self._meshed or any(zid < self._zid for zid in self._robots)

    def warnings(self) -> list[str]:
        """Say what is wrong with the app side, for the status."""
        if self._meshed:
            return [MESHED]
        who = "another daemon" if self.aside else "this daemon"
        return [
            *(JOINED.format(robot=robot, who=who) for robot in sorted(set(self._robots.values()))),
            *(REACHED.format(robot=robot) for robot in sorted(set(self._reached.values()))),
        ]

    def close(self) -> None:
        """Be gone."""
        for declared in self._declared:
            declared.undeclare()
        self._declared = []

    def _notice(self, sample: zenoh.Sample) -> None:
        token, here = str(sample.key_expr), sample.kind == zenoh.SampleKind.PUT
        robot, zid = keys.robot_of(token), keys.zid_of(token)
        with self._lock:
            if token == keys.alive(self._robot, self._mesh):
                self._meshed = here
            elif token == keys.alive(robot, zid):
                self._reached = _noted(self._reached, zid, robot, here=here)
            elif zid != self._zid:
                self._robots = _noted(self._robots, zid, robot, here=here)
        self._changed()


def _noted(robots: dict[str, str], zid: str, robot: str, *, here: bool) -> dict[str, str]:
    """Return a new dictionary: others read the old one without a lock."""
    others = {other: name for other, name in robots.items() if other != zid}
    return others | {zid: robot} if here else others
