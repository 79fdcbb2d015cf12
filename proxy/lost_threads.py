"""A thread of the daemon that an error ended: where the daemon cannot do without it, it ends, to be started anew.

What our own threads do fails where Zenoh has panicked: its routes are lost for good then, and only a new process helps.
"""

import logging
import os
import signal
import threading
from types import TracebackType

log = logging.getLogger(__name__)

SPARED = frozenset({"costly features", "lookout", "metrics", "prepare", "profiler", "recorder"})
"""Without these threads samples cross as before."""


class LostThreads:
    """Notes from now on, for this process, when a thread is lost, and asks the process to stop."""

    def __init__(self) -> None:
        self.any = False
        self._before = threading.excepthook
        threading.excepthook = self._note

    def close(self) -> None:
        """Note nothing more."""
        threading.excepthook = self._before

    def _note(self, lost: threading.ExceptHookArgs) -> None:
        name = lost.thread.name if lost.thread is not None else "?"
        spared = name in SPARED
        log.critical(
            "the thread %s ended with an error; %s",
            name,
            "what it does is not done any more" if spared else "the daemon ends: it cannot do without it",
            exc_info=_error(lost),
        )
        if not (spared or self.any):
            self.any = True
            os.kill(os.getpid(), signal.SIGTERM)


def _error(lost: threading.ExceptHookArgs) -> tuple[type[BaseException], BaseException, TracebackType | None]:
    return lost.exc_type, lost.exc_value or lost.exc_type(), lost.exc_traceback
