"""The first part of a start: sessions are opened, and others of our name listened for.

That takes time during which most of the daemon can be imported, so this imports little itself.
"""

from contextlib import ExitStack

from proxy.bridge.naming import Naming
from proxy.bridge.radio import Scouted
from proxy.bridge.sides import open_sides
from proxy.config import Config
from proxy.tuning import TUNING


class Opening:
    """Opens all sessions; `closing` closes them, whoever has it. Raises `ProxyError`; then nothing is left open."""

    def __init__(self, config: Config) -> None:
        self.scouted = Scouted(config.mesh.interface) if config.mesh.scouts else None
        with ExitStack() as opened:
            self.sides = open_sides(config.app, config.mesh, opened, TUNING.farewell)
            self.naming = Naming(self.sides.mesh, config.robot)
            self.closing = opened.pop_all()
