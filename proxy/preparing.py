"""Loads what decisions compute with: once there is something to decide, and on a thread of its own.

NumPy and what uses it take 13 MB and 0.1 s. A daemon through which nothing covered goes does without. Where something
does, they are there before samples compete for room: the market has to wait for them only within that first moment.
"""

from importlib import import_module
from threading import Thread

MODULE = "proxy.core.market.prices"
"""What the core imports when streams compete, and NumPy with it."""


class Preparation:
    """Begins once, when the first stream that specs cover is known."""

    def __init__(self) -> None:
        self.begun = False

    def begin(self) -> None:
        """Load it on another thread, unless that has begun before."""
        if not self.begun:
            self.begun = True
            Thread(target=import_module, args=(MODULE,), name="prepare", daemon=True).start()
