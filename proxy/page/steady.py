"""Rates over some seconds: what other robots do a daemon hears in digests, which come less often than it is asked."""

from collections import deque
from dataclasses import replace

from proxy.page.tuning import TUNING
from proxy.quantities import Status
from proxy.top.frames import Scene
from proxy.top.rates import Change


class Steady:
    """Remembers what daemons said lately."""

    def __init__(self) -> None:
        self._said: dict[str, deque[Status]] = {}
        """The statuses of each daemon, by its id, the oldest first."""

    def over(self, scene: Scene) -> Scene:
        """Return a scene with each daemon's changes over `count_window`, or as much of it as there is."""
        self._said = {zid: self._said.get(zid, deque()) for zid in scene.changes}
        return replace(scene, changes={zid: self._change(zid, change) for zid, change in scene.changes.items()})

    def _change(self, zid: str, change: Change) -> Change:
        said, now = self._said[zid], change.now
        if said and _uptime(said[-1]) > _uptime(now):
            said.clear()  # it started anew
        if not said or said[-1] is not now:
            said.append(now)
        while len(said) > 2 and _uptime(now) - _uptime(said[1]) >= TUNING.count_window:
            said.popleft()
        return Change(now, said[0] if said[0] is not now else None)


def _uptime(status: Status) -> float:
    return float(status.get("uptime", 0.0))
