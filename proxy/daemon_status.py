"""What `sendworthy status` shows of a daemon: what its core says, and what its other parts say."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from proxy import clock
from proxy.bridge.bridge import Bridge
from proxy.bridge.broadcast import Broadcast
from proxy.bridge.lookout import Lookout, around
from proxy.bridge.neighbours import Neighbours
from proxy.bridge.presence import Presence
from proxy.bridge.radio import Scouted
from proxy.bridge.sides import Sides
from proxy.config import Config
from proxy.features import Extractor
from proxy.loop import Loop
from proxy.planning import Planning
from proxy.profiling.profiler import Profiler
from proxy.recording.recording import Recording
from proxy.reloading import Reloading


@dataclass(frozen=True, slots=True)
class DaemonStatus:
    """Asks the parts of a daemon, on the loop's thread. `scouted` is there where other robots are looked for."""

    config: Config
    sides: Sides
    loop: Loop
    bridge: Bridge
    presence: Presence
    extractor: Extractor
    neighbours: Neighbours
    lookout: Lookout
    scouted: Scouted | None
    reloading: Reloading
    profiler: Profiler
    recording: Recording
    planning: Planning

    def read(self) -> dict[str, Any]:
        """Return the whole status as plain JSON data."""
        return self._with_parts(self.loop.core.status)

    def live(self) -> dict[str, Any]:
        """Return the same, but of the streams only what `sendworthy top` shows."""
        return self._with_parts(self.loop.core.live)

    def totals(self) -> dict[str, Any]:
        """Return the same, but in place of the streams totals by information type."""
        return self._with_parts(self.loop.core.totals)

    def _with_parts(self, of_core: Callable[[float], dict[str, Any]]) -> dict[str, Any]:
        self.bridge.flush()
        self.presence.floods.flush(clock.monotonic())
        status = of_core(clock.monotonic())
        return status | {"warnings": [*status.get("warnings", ()), *self._warnings()], "daemon": self._describe()}

    def _describe(self) -> dict[str, Any]:
        sides = self.sides
        return {
            "sessions": {"app": str(sides.app.zid()), "mesh": str(sides.mesh.zid())},
            "app": list(self.config.app.listen),
            "mesh": list(self.config.mesh.listens),
            "waiting": self.loop.waiting,
            "faults": self.loop.feed.faults,
            "refused": self.loop.refused,
            "floods": self.presence.floods.describe(clock.monotonic()),
            "looks": self.lookout.looks,
            "features": {"superseded": self.extractor.superseded},
            "reloads": self.reloading.describe(),
            "specs": os.path.realpath(self.reloading.loaded.config.specs.path),
            **self.bridge.describe(),
            **({"record": self.recording.describe()} if self.recording.told else {}),
            **({"profile": self.profiler.last.brief()} if self.profiler.last else {}),
            **({"broadcast": sides.data.describe()} if isinstance(sides.data, Broadcast) else {}),
        }

    def _warnings(self) -> list[str]:
        peers = self.loop.core.view.peers.values()
        others = {origin: peer.robot for peer in peers for origin in peer.state.origins if origin != peer.zid}
        return [
            *self.neighbours.warnings(),
            *around(self.sides.app, self.sides.mesh, others),
            *self.lookout.warnings(),
            *(self.scouted.warnings() if self.scouted else ()),
            *self.planning.warnings(clock.monotonic()),
            *self.extractor.warnings(clock.monotonic()),
            *self.reloading.warnings(),
            *self.bridge.warnings(),
            *self._unheard(),
            *self.recording.warnings(),
            *self.presence.floods.warnings(clock.monotonic()),
        ]

    def _unheard(self) -> list[str]:
        """Say that no robot is heard where all broadcast."""
        data, view = self.sides.data, self.loop.core.view
        if not isinstance(data, Broadcast):
            return []
        return data.unheard(sum(peer.state.transport == view.settings.transport for peer in view.peers.values()))
