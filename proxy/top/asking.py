"""Asks daemons for their status again and again, on threads: a daemon that is away must not hold up keys."""

import threading
from collections.abc import Callable, Sequence

from proxy.commands.client import Client, NoAnswerError, connected
from proxy.top.fleet import Changes
from proxy.top.frames import Scene
from proxy.top.rates import Change

RETRY = 1.0
"""A daemon that did not answer is asked again after so long at most [s]."""


class Asking:
    """The daemons at some endpoints, asked every `interval` [s]; `news` is called when anything is new."""

    def __init__(self, endpoints: Sequence[str], interval: float, news: Callable[[], None]) -> None:
        self._endpoints = endpoints
        self._interval = interval
        self._news = news
        self._stopped = threading.Event()
        self._lock = threading.Lock()
        self._known: dict[str, dict[str, Change]] = {}
        """What was said at each endpoint, by the ids of daemons."""
        self._away: dict[str, str] = {}
        self._threads = [threading.Thread(target=self._ask, args=(each,), name="top") for each in endpoints]

    def start(self) -> None:
        """Begin."""
        for thread in self._threads:
            thread.start()

    def stop(self) -> None:
        """End; a daemon that is being asked has its time to answer."""
        self._stopped.set()
        for thread in self._threads:
            thread.join()

    @property
    def scene(self) -> Scene:
        """What is known now."""
        with self._lock:
            changes: Changes = {zid: change for known in self._known.values() for zid, change in known.items()}
            away = "; ".join(self._away.values())
        return Scene(changes, away)

    def places(self) -> dict[str, str]:
        """Return where each robot answers itself, by name."""
        with self._lock:
            known = [(change, where) for where, changes in self._known.items() for change in changes.values()]
        return {str(change.now.get("robot")): where for change, where in known}

    @property
    def ready(self) -> bool:
        """Whether each endpoint has said something twice, or nothing at all."""
        with self._lock:
            return all(
                each in self._away or any(change.before for change in self._known.get(each, {}).values())
                for each in self._endpoints
            )

    def _ask(self, endpoint: str) -> None:
        while not self._stopped.is_set():
            try:
                with connected(endpoint) as client:
                    self._go_on(endpoint, client)
            except NoAnswerError as error:
                with self._lock:
                    self._away[endpoint] = str(error)
                self._news()
                self._stopped.wait(min(self._interval, RETRY))

    def _go_on(self, endpoint: str, client: Client) -> None:
        """Ask until there is no answer. Raises NoAnswerError."""
        while not self._stopped.is_set():
            statuses = client.status(None, live=True)
            with self._lock:
                before = self._known.get(endpoint, {})
                self._known[endpoint] = {
                    zid: before[zid].then(status) if zid in before else Change(status)
                    for zid, status in ((str(status.get("zid")), status) for status in statuses)
                }
                self._away.pop(endpoint, None)
            self._news()
            self._stopped.wait(self._interval)
