"""The page's parts, put together: what is seen goes to all who watch, what they order goes to the fleet."""

import logging
import threading
from collections import deque
from collections.abc import Sequence
from typing import Any

from proxy import clock
from proxy.page import fleet
from proxy.page.frames import Frames, message
from proxy.page.hub import Hub
from proxy.page.orders import Orders
from proxy.page.steady import Steady
from proxy.page.tuning import TUNING
from proxy.page.variants import variant_of
from proxy.page.watch import Watch
from proxy.top.asking import Asking

log = logging.getLogger(__name__)

STATUS, HISTORY = "status", "history"


class Page:
    """Looks at a fleet every `interval` [s], through daemons at `endpoints`: the first one is the operator's own.

    Orders are proved with the team's `token`, if there is one.
    """

    def __init__(
        self, endpoints: Sequence[str], robot: str | None, keys: Sequence[str], interval: float, token: str = ""
    ) -> None:
        self.hub = Hub(self._greeting)
        self._interval = interval
        self._frames = Frames(self.hub.put)
        self.watch = Watch(endpoints[0], robot, keys, self._frames.take)
        self._asking = Asking(endpoints, interval, lambda: None)
        self.orders = Orders(endpoints[0], lambda: self.watch.robot, self._asking.places, token)
        self._past: deque[dict[str, Any]] = deque(maxlen=max(2, int(TUNING.history / interval)))
        self._steady = Steady()
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, name="look")

    def start(self) -> None:
        """Begin to look."""
        self._asking.start()
        self.watch.start()
        self._thread.start()

    def stop(self) -> None:
        """End."""
        self._stopped.set()
        self._thread.join()
        self.watch.stop()
        self._asking.stop()

    def specs(self) -> dict[str, Any]:
        """Return the specs in force, for the editor."""
        found = self.watch.in_force
        return {"generation": found.generation, "files": dict(found.files), "variant": variant_of(found.files)}

    def _run(self) -> None:
        while not self._stopped.wait(self._interval):
            try:
                self._look()
            except Exception:
                log.exception("what daemons say cannot be shown")

    def _look(self) -> None:
        """Show what is known now."""
        scene, now, name = self._steady.over(self._asking.scene), clock.monotonic(), self.watch.robot
        in_force = self.watch.in_force
        self._frames.know(fleet.delays(scene, name))
        told = fleet.described(scene, in_force, self._frames.rates(now), name)
        point = {
            "t": now,
            "worth": told["worth"],
            "limits": {
                str(each["constraint"]): [each["used_by_all"], each["limit"], each["price_per_kb"]]
                for each in told["limits"]
            },
        }
        self._past.append(point)
        more = {
            "away": scene.away or self.watch.problem,
            "point": point,
            "demo": self.watch.demo,
            "variant": variant_of(in_force.files),
        }
        self.hub.put(STATUS, message({**told, **more}))

    def _greeting(self) -> dict[str, bytes]:
        """What whoever opens the page is told first."""
        return {HISTORY: message({"kind": HISTORY, "points": list(self._past)})}
