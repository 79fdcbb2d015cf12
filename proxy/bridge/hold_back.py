"""The hold-back queue: what a robot sends anew waits until the copies that it kept for us are here.

A robot whose link was down sends us copies of what we missed, one by one, and meanwhile what its applications publish.
So that each stream comes in order, new samples of a robot that was lost are held back: from its return until it tells
of which keys copies wait, and of those until it tells that there are none any more. That is for streams of which each
sample counts. Nothing is held back for long: a robot that tells nothing, and sends no copies, is not waited for.
"""

import math
import threading
from collections import Counter, OrderedDict, deque
from collections.abc import Callable
from dataclasses import dataclass, replace

import zenoh

from proxy import clock
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.budget import Bucket
from proxy.bridge.sample import origin_of
from proxy.bridge.tuning import TUNING


@dataclass(frozen=True, slots=True)
class _Return:
    """A robot that was lost. Since `since` [s] it is waited for; `keys` are those of its copies, None: any.

    `number` is that of its last word, 0: it said nothing yet.
    """

    since: float = math.inf
    back: bool = False
    number: int = 0
    keys: frozenset[str] | None = None

    def concerns(self, key: str) -> bool:
        return self.keys is None or key in self.keys


@dataclass(frozen=True, slots=True)
class _Held:
    since: float
    size: int
    stamp: zenoh.Timestamp | None
    hand: Callable[[], None]

    def comes_before(self, stamp: zenoh.Timestamp) -> bool:
        return self.stamp is None or self.stamp <= stamp

    def follows(self, stamp: zenoh.Timestamp | None) -> bool:
        return stamp is not None and not self.comes_before(stamp)


class HoldBack:
    """Hands samples on in order; `sender` tells the tag of the robot whose stamp has an origin, empty: nobody knows.

    From any thread.
    """

    def __init__(self, sender: Callable[[str], str]) -> None:
        self._sender = sender
        self._lock = threading.Lock()
        self._returns: OrderedDict[str, _Return] = OrderedDict()
        self._senders: OrderedDict[str, str] = OrderedDict()
        """Who stamps with an origin, known from before it was lost."""
        self._streams: dict[tuple[str, str], deque[_Held]] = {}
        """By key and origin, the oldest first."""
        self._count = self._bytes = 0
        self._due: deque[tuple[tuple[str, str], _Held]] = deque()
        """What waits no more, in order, by its stream..."""
        self._going = Counter[tuple[str, str]]()
        """... and how many samples of a stream that are, or are being handed on: what is new of it comes after them."""
        self._handing = threading.Lock()
        """Held by who hands on. Beside an application that hangs that takes seconds, so it is never done in `_lock`."""
        self._budget = Bucket(clock.monotonic(), BOUNDS.returns, BOUNDS.returns_at_once)
        self.held = 0
        """Samples that were held back."""

    @property
    def waits(self) -> bool:
        """Whether any sample may have to wait."""
        return bool(self._returns or self._streams or self._going)

    def lost(self, tag: str) -> None:
        """A robot has vanished. What waits no more for it is handed on at the next check."""
        with self._lock:
            holding = any(self._tag(origin) == tag for _, origin in self._streams)
            self._returns.pop(tag, None)
            self._returns[tag] = _Return(clock.monotonic() if holding else math.inf)
            if len(self._returns) > BOUNDS.held_robots:
                self._returns.popitem(last=False)
            self._release()

    def found(self, tag: str) -> None:
        """A robot is there, or back. Called before anything is heard that it sends from now on.

        What waits no more for it is handed on at the next check.
        """
        now = clock.monotonic()
        with self._lock:
            known = self._returns.pop(tag, None)
            if known is not None and self._budget.take(now):
                self._returns[tag] = replace(known, since=now, back=True, keys=known.keys if known.number else None)
            self._release()

    def note_backlog(self, tag: str, number: int, keys: frozenset[str] | None) -> None:
        """A robot tells, for the time `number`, of which keys copies wait for us; None: of too many to name."""
        with self._lock:
            known = self._returns.get(tag)
            if known is None or number <= known.number:
                return
            if known.back and keys is not None and not keys:
                del self._returns[tag]
            else:
                since = clock.monotonic() if known.back else known.since
                self._returns[tag] = replace(known, since=since, number=number, keys=keys)
            self._release()
        self._hand_on()

    def takes(self, key: str, stamp: zenoh.Timestamp | None, size: int, hand: Callable[[], None]) -> bool:
        """Whether a new sample is held back; then `hand` is called when its turn comes.

        One that is not comes after what was held back of its stream: whoever brings it waits for that.
        """
        stream = key, "" if stamp is None else origin_of(stamp)
        with self._lock:
            held = self._holds(stream, stamp, size, hand)
            follows = not held and stream in self._going
        if follows:
            self._hand_on(wait=True)
        return held

    def _holds(
        self, stream: tuple[str, str], stamp: zenoh.Timestamp | None, size: int, hand: Callable[[], None]
    ) -> bool:
        """Hold a new sample back if it has to wait, and there is room; else free all of its stream."""
        key, origin = stream
        tag = self._tag(origin)
        if stream not in self._streams and not self._waits(key, tag):
            return False
        if self._count >= BOUNDS.held_samples or self._bytes + size > BOUNDS.held_bytes:
            self._free_all(stream)
            return False
        now = clock.monotonic()
        if (known := self._returns.get(tag)) is not None:
            self._returns[tag] = replace(known, since=min(known.since, now))
        waiting = self._streams.setdefault(stream, deque())
        # A small sample that found room at once may have overtaken large ones of its stream.
        place = next((i for i in range(len(waiting), 0, -1) if not waiting[i - 1].follows(stamp)), 0)
        waiting.insert(place, _Held(now, size, stamp, hand))
        self._count, self._bytes, self.held = self._count + 1, self._bytes + size, self.held + 1
        return True

    def copied(self, key: str, stamp: zenoh.Timestamp | None) -> None:
        """A copy arrives: what is held back of its stream and not younger comes first, that very sample included."""
        if stamp is None or not self.waits:
            return
        with self._lock:
            now = clock.monotonic()
            for tag, known in list(self._returns.items()):
                if known.back and known.concerns(key):
                    self._returns[tag] = replace(known, since=now)
            stream = key, origin_of(stamp)
            while stream in self._streams and self._streams[stream][0].comes_before(stamp):
                self._free_first(stream)
            follows = stream in self._going
        if follows:
            self._hand_on(wait=True)

    def check(self, now: float) -> None:
        """Wait no more for robots that say nothing; let go what is held back for too long."""
        if not self.waits:
            return
        with self._lock:
            for tag, known in list(self._returns.items()):
                if now < known.since + TUNING.hold_back:
                    continue
                if known.back:
                    del self._returns[tag]
                else:
                    self._returns[tag] = replace(known, since=math.inf, keys=frozenset())
            for stream in list(self._streams):
                while stream in self._streams and now >= self._streams[stream][0].since + TUNING.longest_hold_back:
                    self._free_first(stream)
            self._release()
        self._hand_on()

    def close(self) -> None:
        """Hand on all that is held back."""
        with self._lock:
            self._returns.clear()
            self._release()
        self._hand_on(wait=True)

    def _tag(self, origin: str) -> str:
        tag = self._sender(origin) or self._senders.get(origin, "")
        if tag:
            self._senders[origin] = tag
            self._senders.move_to_end(origin)
            if len(self._senders) > BOUNDS.held_origins:
                self._senders.popitem(last=False)
        return tag

    def _waits(self, key: str, tag: str) -> bool:
        """Whether a sample has to wait; one that nobody knows the sender of for any robot that is back."""
        if tag:
            return (known := self._returns.get(tag)) is not None and known.concerns(key)
        return any(known.back and known.concerns(key) for known in self._returns.values())

    def _release(self) -> None:
        """Free what need not wait any more."""
        for key, origin in list(self._streams):
            if not self._waits(key, self._tag(origin)):
                self._free_all((key, origin))

    def _free_all(self, stream: tuple[str, str]) -> None:
        while stream in self._streams:
            self._free_first(stream)

    def _free_first(self, stream: tuple[str, str]) -> None:
        waiting = self._streams[stream]
        self._due.append((stream, waiting.popleft()))
        self._going[stream] += 1
        if not waiting:
            del self._streams[stream]

    def _hand_on(self, *, wait: bool = False) -> None:
        """Hand on what is due. Whoever does so already does all of it: we `wait` until it has, or leave it to that."""
        while self._due or wait:
            if not self._handing.acquire(blocking=wait):
                return
            try:
                while self._due:
                    self._hand(*self._due.popleft())
            finally:
                self._handing.release()
            wait = False

    def _hand(self, stream: tuple[str, str], held: _Held) -> None:
        try:
            held.hand()
        finally:
            with self._lock:
                self._count, self._bytes = self._count - 1, self._bytes - held.size
                self._going[stream] -= 1
                if not self._going[stream]:
                    del self._going[stream]
