"""Loads what decisions compute with: once there may be something to decide, and on a thread of its own.

NumPy, what uses it and the engine take 15 MB and 0.1 s. A daemon through which nothing covered goes, and from which
nobody wants anything that is, does without. Else they are there before samples compete for room: the market has to wait
for them only where somebody subscribes within that moment.
"""

from collections.abc import Collection
from importlib import import_module
from threading import Thread

from proxy.core.core import Core
from proxy.core.view.subscribers import intersects
from utility_specs import Specs

MODULE = "proxy.core.market.prices"
"""What the core imports when streams compete, and NumPy with it."""
ENGINE = "planner.native_engine"
"""What searches with it."""
MANY = 2000
"""Of so many pairs of key expressions one will match: it is not looked for."""


class Preparation:
    """Begins once, when a stream is known that specs cover, or when others want such streams of ours.

    That Zenoh says at once, and their robots say in their states. Of eight robots that began on two cores the states
    came seconds late: all loaded at their first samples, and those waited for 0.2 s.
    """

    def __init__(self) -> None:
        self.begun = False
        self._seen: tuple[int, Specs | None] = -1, None
        """After how many changes of streams and of who wants them, and under which specs, it was looked for last."""

    def follow(self, core: Core) -> None:
        """See whether it is time to begin. Called after every event: cheap when nothing is new."""
        if self.begun:
            return
        seen = core.view.streams.revision, core.view.specs
        if seen[0] == self._seen[0] and seen[1] is self._seen[1]:
            return
        self._seen = seen
        if core.decides_soon:
            self.begin()

    def wanted(self, expressions: Collection[str], specs: Specs) -> None:
        """Nodes on the mesh want these key expressions: begin if the specs limit such streams. From any thread."""
        if self.begun or not specs.constraints:
            return
        planned = [key for each in specs.types if each.planned for key in each.keys]
        many = len(planned) * len(expressions) > MANY
        if many or any(intersects(each, key) for key in planned for each in expressions):
            self.begin()

    def begin(self) -> None:
        """Load it on another thread, unless that has begun before."""
        if not self.begun:
            self.begun = True
            Thread(target=_load, name="prepare", daemon=True).start()


def _load() -> None:
    for module in (MODULE, ENGINE):
        import_module(module)
