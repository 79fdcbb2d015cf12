"""Keeps queries from overtaking what was declared before them."""

import threading
from collections.abc import Callable

PATIENCE = 1.0
"""How long a query waits for what was declared before it [s]; a mesh that stands still must not hold up all others."""


class Fence:
    """Whoever has drawn a `mark` can wait until everything declared before that is mirrored.

    The one who mirrors says when it begins to look at what is declared and when it has mirrored that. `wake` asks it
    to look.
    """

    def __init__(self, wake: Callable[[], None]) -> None:
        self._wake = wake
        self._begun = 0
        self._ended = 0
        self._turn = threading.Condition()

    def mark(self) -> int:
        """Remember this moment. Never waits."""
        return self._begun

    def begin(self) -> None:
        """Say that from now on is seen what is declared by now."""
        self._begun += 1

    def end(self) -> None:
        """Say that what was seen is mirrored."""
        with self._turn:
            self._ended = self._begun
            self._turn.notify_all()

    def wait(self, mark: int) -> bool:
        """Wait until all declared before `mark` is mirrored; whether that is so, after `PATIENCE` at the latest."""
        with self._turn:
            if self._ended <= mark:
                self._wake()
            return self._turn.wait_for(lambda: self._ended > mark, PATIENCE)
