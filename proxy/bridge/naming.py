"""The name of a daemon: another one than configured where the mesh has one of that name."""

import logging
import threading

import zenoh

from proxy import clock
from proxy.bridge import keys
from proxy.bridge.declaration import Declaration
from proxy.bridge.tuning import TUNING

log = logging.getLogger(__name__)


class Naming:
    """Listens from the beginning: what else a start takes need not wait for it."""

    def __init__(self, mesh: zenoh.Session, robot: str) -> None:
        self._mesh = mesh
        self._robot = robot
        self._until = clock.monotonic() + TUNING.name_wait
        self._taken = threading.Event()
        handler = zenoh.handlers.Callback(self._take, indirect=False)
        self._watch: Declaration = mesh.liveliness().declare_subscriber(keys.alive(robot, "*"), handler, history=True)

    def name(self) -> str:
        """Return our name, or `<name>-<zid4>` when the mesh has a daemon of that name, which is said loudly. Once."""
        found = self._taken.wait(max(0.0, self._until - clock.monotonic()))
        self._watch.undeclare()
        if not found:
            return self._robot
        name = f"{self._robot}-{str(self._mesh.zid())[:4]}"
        log.error(
            "another daemon on the mesh is called %r; this one runs as %r: give it a name of its own", self._robot, name
        )
        return name

    def _take(self, _: zenoh.Sample) -> None:
        self._taken.set()
