"""Who on the mesh wants a key, and how often a sample of it is transmitted."""

import threading
from collections import deque
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial

import zenoh

from proxy import clock
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.declaration import matches
from proxy.bridge.keys import on_air
from proxy.bridge.sample import Parcel
from proxy.core.interface.events import MatchingChanged
from proxy.core.view.subscribers import intersects

_PUT = zenoh.SampleKind.PUT


@dataclass(frozen=True, slots=True)
class Outlet:
    """A declared publisher: cheaper than publishing with the session, but of one quality of service."""

    publisher: zenoh.Publisher
    priority: zenoh.Priority
    congestion_control: zenoh.CongestionControl
    express: bool

    def suits(self, sample: zenoh.Sample | Parcel) -> bool:
        """Whether what it publishes is like `sample`."""
        quality = sample.priority, sample.congestion_control, sample.express, sample.kind
        return quality == (self.priority, self.congestion_control, self.express, _PUT)


class Demand:
    """Follows the demand for our own keys.

    Whether anybody wants a key Zenoh tells, by a publisher's matching status; how many do is known from what robots say
    they subscribe to: a sample is transmitted once for each. When all is `relayed` by a router, it goes on the air to
    the router, and from there to each robot that wants it; nodes that are no robots are beyond the router and cost
    nothing. With `broadcast` samples travel once, elsewhere, where Zenoh knows of no demand; that on the mesh session
    holds there too. `post` learns of every change for keys that an information type covers; `wake` is called when
    `update` has something to do.
    """

    def __init__(
        self,
        mesh: zenoh.Session,
        post: Callable[[MatchingChanged], None],
        wake: Callable[[], None],
        *,
        broadcast: bool = False,
        relayed: bool = False,
    ) -> None:
        self._broadcast = broadcast
        self._mesh = mesh
        self._post = post
        self._wake = wake
        self._relayed = relayed
        self._lock = threading.Lock()
        self._seen: dict[str, bool] = {}
        self._new: deque[tuple[str, zenoh.Sample]] = deque()
        self._turned: set[str] = set()
        self._matching: dict[str, bool] = {}
        self._outlets: dict[str, Outlet] = {}
        self._robots: dict[str, tuple[str, ...]] = {}
        self._counts: dict[str, int] = {}

    def note(self, key: str, sample: zenoh.Sample, *, covered: bool) -> None:
        """Follow `key` from now on. Called for every sample: cheap when nothing is new."""
        known = self._seen.get(key)
        if known is covered or (known is None and len(self._seen) >= BOUNDS.demanded_keys):
            return
        with self._lock:  # samples of one key may come on several threads
            known = self._seen.get(key)
            self._seen[key] = covered
            if known is None:
                self._new.append((key, sample))
            if covered:  # until it is known, somebody is taken to want it: else what crosses meanwhile costs nothing
                self._post(MatchingChanged(clock.monotonic(), key, self._matching.get(key, True)))
        self._wake()

    def outlet(self, key: str) -> Outlet | None:
        """Return the publisher of a key that is followed; it is as the first sample was. In broadcast there is none."""
        return None if self._broadcast else self._outlets.get(key)

    def note_robot(self, zid: str, subscriptions: Iterable[str]) -> None:
        """Take in what a robot says that its apps subscribe to; nothing when it is gone."""
        wanted = tuple(subscriptions)
        with self._lock:
            robots = {robot: keys for robot, keys in self._robots.items() if robot != zid}
            self._robots = robots | {zid: wanted} if wanted else robots
            self._counts = {}

    def copies(self, key: str) -> int:
        """Return how often a sample of `key` is transmitted; at least once unless it is known that nobody wants it."""
        if not self._matching.get(key, True):
            return 0
        if self._broadcast and on_air(key):
            return 1
        counts = self._counts
        if (count := counts.get(key)) is None:
            if len(counts) >= BOUNDS.keys:
                counts.clear()
            robots = self._robots.values()
            count = counts[key] = sum(any(intersects(each, key) for each in wanted) for wanted in robots)
        return count + 1 if self._relayed else max(1, count)

    def wanting(self, key: str) -> set[str]:
        """Return the robots, by their sessions, that say they want `key`."""
        return {zid for zid, wanted in self._robots.items() if any(intersects(each, key) for each in wanted)}

    def silent(self, key: str) -> bool:
        """Whether `key` must not be published: on a mesh session Zenoh sees to that itself, on the air it does not.

        Who was silent so far asks Zenoh, for it tells later: a sample for a token that was just seen would be lost.
        """
        if not self._broadcast or self._matching.get(key, True):
            return False
        outlet = self._outlets.get(key)
        return outlet is None or not matches(outlet.publisher)

    def update(self) -> None:
        """Declare publishers for new keys, and hear those that turned. May block for as long as the mesh does."""
        while self._new:
            key, sample = self._new.popleft()
            kind = sample.priority, sample.congestion_control, sample.express
            publisher = self._mesh.declare_publisher(
                key,
                priority=kind[0],
                congestion_control=kind[1],
                express=kind[2],
                allowed_destination=zenoh.Locality.REMOTE,
            )
            self._outlets[key] = Outlet(publisher, *kind)
            handler = zenoh.handlers.Callback(partial(self._hear, key), indirect=False)
            publisher.declare_matching_listener(handler)
            self._turned.add(key)
        while self._turned:
            key = self._turned.pop()
            if (outlet := self._outlets.get(key)) is not None:
                self._set(key, matching=matches(outlet.publisher))

    def close(self) -> None:
        """Follow nothing more."""
        outlets, self._outlets = self._outlets, {}
        for outlet in outlets.values():
            with suppress(RuntimeError):  # it is in a put that stalls: then it ends with its session
                outlet.publisher.undeclare()  # type: ignore[no-untyped-call] # an omission of Zenoh's stubs

    @property
    def wanted(self) -> int:
        """How many of our keys somebody wants."""
        return sum(self._matching.values())

    def _hear(self, key: str, _: zenoh.MatchingStatus) -> None:
        # What it says is not kept: it may be told after what is asked later.
        self._turned.add(key)
        self._wake()

    def _set(self, key: str, *, matching: bool) -> None:
        with self._lock:
            news = self._matching.get(key, True) != matching
            self._matching[key] = matching
            if news and self._seen[key]:
                self._post(MatchingChanged(clock.monotonic(), key, matching))
