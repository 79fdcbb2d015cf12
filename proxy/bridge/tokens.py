"""Presence tokens as they come and go, in order for each robot, and bounded."""

import re
import threading
from collections import Counter
from collections.abc import Callable
from functools import partial

from proxy import clock
from proxy.bridge import keys
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.budget import Bucket
from proxy.core.interface.events import Event, PeerAppeared, PeerGone
from proxy.core.protocol.messages import tag

_ZID = re.compile("[0-9a-f]{1,32}")

Job = Callable[[], Event | None]
Post = Callable[[Event | Job], object]
Later = Callable[[float, Job], object]
Refuse = Callable[[float, str, str], object]
Turned = Callable[[str], object]
Forged = Callable[[str, str], bool]
Absent = Callable[[str], bool]
"""Whether nobody is linked who has a session."""
Place = tuple[str, str]
"""The robot of a token, and its session."""


class Tokens:
    """Tells the core by `post` what became of each token; `own` is the session that shows ours.

    `later` posts at a time [s, our clock]. `refuse` gets the robot and the kind of what is no presence token. `lost`
    and `found` get the tag of who vanished or is there, at once. `forged` tells whether a robot cannot be the one with
    such a session, `absent` whether nobody is linked who has it, nor can be behind a router; on the loop's thread.
    `strange` tells at once whether there seems to be no link.

    Tokens cost nothing, links do. So those without a link take no more than half of the room, and count for nothing
    as long as their sessions are absent.
    """

    def __init__(
        self,
        own: str,
        post: Post,
        later: Later,
        refuse: Refuse,
        *,
        lost: Turned,
        found: Turned,
        forged: Forged,
        absent: Absent,
        strange: Absent,
    ) -> None:
        self._forged = forged
        self._absent = absent
        self._strange = strange
        self._own = own
        self._post = post
        self._later = later
        self._refuse = refuse
        self._lost = lost
        self._found = found
        self._changes = Bucket(clock.monotonic(), BOUNDS.all_token_changes, BOUNDS.all_token_changes_at_once)
        self._own_changes: dict[Place, Bucket] = {}
        self._lock = threading.Lock()
        self._there: set[Place] = set()
        self._news: dict[Place, bool] = {}
        self._told: set[Place] = set()
        """Those that the core knows of."""
        self._counted: set[Place] = set()
        """Those of which somebody is, or was, linked who has the session."""
        self.tags: Counter[str] = Counter()
        """The tags of these, and how many have each."""

    def note(self, token: str, *, there: bool) -> None:
        """A token appeared or vanished. From any thread; the last word holds if the loop is behind."""
        robot, zid = keys.robot_of(token), keys.zid_of(token)
        if zid == self._own:
            return
        place = robot, zid
        if len(robot) > BOUNDS.name_length or not _ZID.fullmatch(zid):
            self._refuse(clock.monotonic(), robot[: BOUNDS.name_length], "token:malformed")
            return
        with self._lock:
            if not self._take_note(place, there=there):
                return
            waiting = place in self._news
            self._news[place] = there
        if not waiting:
            self._post(partial(self._tell, place))

    def _take_note(self, place: Place, *, there: bool) -> bool:
        """Whether a token is one of those that we follow."""
        if not there:
            known = place in self._there
            self._there.discard(place)
            self._discount(place)
            return known
        strange = self._strange(place[1])
        room = BOUNDS.tokens // 2 if strange else BOUNDS.tokens
        if len(self._there) >= room or len(self._news) >= 2 * room:
            return False
        self._there.add(place)
        if not strange:
            self._count(place)
        return True

    def _last_word(self, place: Place) -> bool:
        """Return whether a token is there, for its robot to be told of."""
        with self._lock:
            there = self._news.pop(place)
            if there:
                self._count(place)
            return there

    def _count(self, place: Place) -> None:
        if place in self._counted:
            return
        name = tag(place[1])
        self._counted.add(place)
        self.tags[name] += 1
        if self.tags[name] == 1:
            self._found(name)

    def _discount(self, place: Place) -> None:
        if place not in self._counted:
            return
        name = tag(place[1])
        self._counted.remove(place)
        self.tags[name] -= 1
        if not self.tags[name]:
            del self.tags[name]
            self._lost(name)

    def _tell(self, place: Place, *, again: bool = False, unlinked: int = 0) -> Event | None:
        """Tell the last word on a robot, or put it off. Who was gone before anybody knew of it is no news.

        It was put off `again`, as there were too many, or so often as nobody is linked who shows the token.
        """
        now = clock.monotonic()
        with self._lock:
            if not self._news[place] and place not in self._told:
                del self._news[place]
                return None
            there = self._news[place]
        if there and self._absent(place[1]):
            if unlinked == 1:  # a link may be there a moment after its token
                self._refuse(now, place[0], "token:no link")
            self._later(now + BOUNDS.unlinked_retry, partial(self._tell, place, unlinked=unlinked + 1))
            return None
        own = self._own_changes.get(place)
        if own is None:
            if len(self._own_changes) > 2 * BOUNDS.tokens:
                self._own_changes.clear()
            own = self._own_changes[place] = Bucket(now, BOUNDS.token_changes, BOUNDS.token_changes_at_once)
        room = own.take(now)
        if room and not self._changes.take(now):
            room = False
            own.give_back()
        if not room:
            if not again:
                self._refuse(now, place[0], "token:flood")
            self._later(now + BOUNDS.token_retry, partial(self._tell, place, again=True))
            return None
        there = self._last_word(place)
        if there and self._forged(*place):
            self._refuse(now, place[0], "token:forged")
            return None
        (self._told.add if there else self._told.discard)(place)
        return (PeerAppeared if there else PeerGone)(now, *place)
