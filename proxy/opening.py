"""The first part of a start: sessions are opened, and others of our name listened for.

That takes time during which most of the daemon can be imported, so this imports little itself.
"""

from contextlib import ExitStack

from proxy.bridge.naming import Naming
from proxy.bridge.radio import Scouted
from proxy.bridge.sides import open_sides
from proxy.config import Config

_FAREWELL = 0.15
"""How long the routers of the app side have to take note of each other's end [s]."""


class Opening:
    """Opens all sessions; `closing` closes them, whoever has it. Raises `ProxyError`; then nothing is left open."""

    def __init__(self, config: Config) -> None:
        self.scouted = Scouted(config.mesh.interface) if config.mesh.scouts else None
        with ExitStack() as opened:
            self.sides = open_sides(config.app, config.mesh, opened, _FAREWELL)
            self.naming = Naming(self.sides.mesh, config.robot)
            self.closing = opened.pop_all()
