"""Brings messages to all who watch: of each kind the newest, so that a slow browser gets fewer, and holds up nobody."""

import asyncio
import threading
from collections.abc import AsyncIterator, Callable

from proxy.page.tuning import TUNING


class Viewer:
    """One open page: of what waits for it there is one message of each name at most.

    `put` and `close` may be called on any thread, `messages` runs on the event loop.
    """

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._lock = threading.Lock()
        self._pending: dict[str, bytes] = {}
        self._news = asyncio.Event()
        self._closed = False
        self.dropped = 0
        """Messages that a newer one replaced before they went."""

    def put(self, name: str, message: bytes) -> None:
        """Have a message sent soon, in place of an older one of its name."""
        with self._lock:
            if self._closed:
                return
            self.dropped += name in self._pending
            self._pending[name] = message
            self._loop.call_soon_threadsafe(self._news.set)

    def close(self) -> None:
        """Send nothing more. Does nothing the second time."""
        with self._lock:
            if self._closed:
                return
            self._closed = True
            self._pending.clear()
            self._loop.call_soon_threadsafe(self._news.set)

    async def messages(self) -> AsyncIterator[bytes]:
        """Yield messages until closed. The next one is chosen when it is asked for, so it is the newest."""
        while not self._closed:
            await self._news.wait()
            message = self._next()
            if message is not None:
                yield message

    def _next(self) -> bytes | None:
        with self._lock:
            if not self._pending:
                self._news.clear()
                return None
            return self._pending.pop(next(iter(self._pending)))


class Hub:
    """All open pages. `greet` gives what each is told first, by name."""

    def __init__(self, greet: Callable[[], dict[str, bytes]]) -> None:
        self._greet = greet
        self._lock = threading.Lock()
        self._viewers: list[Viewer] = []

    def put(self, name: str, message: bytes) -> None:
        """Bring a message to all, in place of an older one of its name that still waits. On any thread."""
        with self._lock:
            viewers = tuple(self._viewers)
        for viewer in viewers:
            viewer.put(name, message)

    def join(self) -> Viewer | None:
        """Return another viewer; None when there are too many. On the event loop."""
        with self._lock:
            if len(self._viewers) >= TUNING.viewers:
                return None
            viewer = Viewer(asyncio.get_running_loop())
            self._viewers.append(viewer)
        for name, message in self._greet().items():
            viewer.put(name, message)
        return viewer

    def leave(self, viewer: Viewer) -> None:
        """Bring it nothing more."""
        viewer.close()
        with self._lock:
            self._viewers.remove(viewer)

    def close(self) -> None:
        """Let all go."""
        with self._lock:
            viewers = tuple(self._viewers)
        for viewer in viewers:
            viewer.close()
