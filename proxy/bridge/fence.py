"""Keeps queries from overtaking what was declared before them."""

import logging
from collections import deque
from collections.abc import Callable

log = logging.getLogger(__name__)


class Fence:
    """Whatever is to be done after all that is declared by now is mirrored.

    The one who mirrors says when it begins to look at what is declared and when it has mirrored that. `wake` asks it
    to look.
    """

    def __init__(self, wake: Callable[[], None]) -> None:
        self._wake = wake
        self._begun = 0
        self._waiting: deque[tuple[int, Callable[[], object]]] = deque()

    def then(self, job: Callable[[], object]) -> None:
        """Have `job` called when all declared by now is mirrored. Never waits."""
        self._waiting.append((self._begun, job))
        self._wake()

    def begin(self) -> bool:
        """Say that from now on is seen what is declared by now; return whether anybody waits for that."""
        self._begun += 1
        return bool(self._waiting)

    def end(self) -> None:
        """Say that what was seen is mirrored, or cannot be."""
        while self._waiting and self._waiting[0][0] < self._begun:
            _, job = self._waiting.popleft()
            try:
                job()
            except Exception:  # as where a session closes; those behind it go all the same, and so does who mirrors
                log.exception("what waited for declarations failed")
