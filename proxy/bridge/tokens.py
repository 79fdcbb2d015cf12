"""Presence tokens as they come and go, in order for each robot, and bounded."""

import re
import threading
from collections.abc import Callable
from functools import partial

from proxy import clock
from proxy.bridge import keys
from proxy.core.events import Event, MalformedHeard, PeerAppeared, PeerGone

MOST = 1024
"""Tokens known at once; more are not believed."""
MOST_NAME = 128
"""Letters in the name of a robot."""
_ZID = re.compile("[0-9a-f]{1,32}")

Job = Callable[[], Event | None]


class Tokens:
    """Tells the core by `post` what became of each token; `own` is the session that shows ours."""

    def __init__(self, own: str, post: Callable[[Event | Job], object]) -> None:
        self._own = own
        self._post = post
        self._lock = threading.Lock()
        self._there: set[tuple[str, str]] = set()
        self._news: dict[tuple[str, str], bool] = {}

    def note(self, token: str, *, there: bool) -> None:
        """A token appeared or vanished. From any thread; the last word holds if the loop is behind."""
        robot, zid = keys.robot_of(token), keys.zid_of(token)
        if zid == self._own:
            return
        place = robot, zid
        if len(robot) > MOST_NAME or not _ZID.fullmatch(zid):
            self._post(MalformedHeard(clock.monotonic(), robot[:MOST_NAME], "token:malformed"))
            return
        with self._lock:
            if not self._take_note(place, there=there):
                return
            waiting = place in self._news
            self._news[place] = there
        if not waiting:
            self._post(partial(self._tell, place))

    def _take_note(self, place: tuple[str, str], *, there: bool) -> bool:
        """Whether a token is one of those that we follow."""
        if not there:
            known = place in self._there
            self._there.discard(place)
            return known
        if len(self._there) >= MOST or len(self._news) >= 2 * MOST:
            return False
        self._there.add(place)
        return True

    def _tell(self, place: tuple[str, str]) -> Event:
        with self._lock:
            there = self._news.pop(place)
        return (PeerAppeared if there else PeerGone)(clock.monotonic(), *place)
