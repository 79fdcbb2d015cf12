"""Publishes on the mesh. A mesh that stalls holds up nothing else.

Samples are published at once, by whoever brings them, while all links surely take them. All else waits for a thread
that may be held up. What was forwarded by a decision is paced to the limit of the channel while
links are busy, so that the queues behind us stay empty (`paced.py`); as soon as they are the next one goes, for what
leaves later than it was decided is in another window than all believe. What passes goes as fast as it can and pushes
the next decided sample back by what it used, up to a floor: decided samples are never starved.

Samples of one key stay in order: whichever way a sample would go, it waits in the queue where one of its key waits. In
shadow, on a link that was full, 10 of 294 samples of a key were overtaken, and none is now.
"""

import threading
from collections import Counter, deque
from collections.abc import Callable

from proxy import clock
from proxy.bridge.broadcast import DataSession
from proxy.bridge.demand import Demand
from proxy.bridge.paced import Item, Paced
from proxy.bridge.passed import EGRESS, FULL, Passed
from proxy.bridge.room import Rooms
from proxy.bridge.sample import Held
from proxy.bridge.send_buffers import SendBuffers
from proxy.bridge.sender import Answer, Sender
from proxy.bridge.tuning import TUNING
from proxy.bridge.writer import Writer


class Egress:
    """Queues what leaves for the mesh, for a thread that writes it.

    `rate` is the pace of decided samples [B/s], copies counted; None: unpaced. `post` gets a `SampleHanded`
    or a `SampleRefused` for each of them, for one that was kept a `CopyHanded` or a `CopyRefused`; the others are
    counted in `passed`.
    """

    def __init__(
        self,
        session: DataSession,
        demand: Demand,
        passed: Passed,
        post: Callable[[Answer], None],
        rate: float | None,
        *,
        rooms: Rooms,
    ) -> None:
        self._rooms = rooms
        self.buffers = SendBuffers(session)
        self.writer = Writer(session, demand, self.buffers)
        self._passed = passed
        self._decided = Paced(rate)
        self._passing: deque[Item] = deque()
        self._deciding_keys, self._passing_keys = Counter[str](), Counter[str]()
        """Of what waits in either queue, or is in hand."""
        self._in_hand = 0
        """Size of the sample that the thread sends, or sent last [B]."""
        self._open = True
        self._sent_at = 0.0
        self._awaited = 0
        """So many passing samples may be left when those who wait for the thread go on."""
        self._slowed = 0
        """Publishers that wait for room."""
        self._busy = False
        """Whether the thread has a passing sample in hand..."""
        self._deciding = False
        """... or a decided one."""
        self._running = False
        self._lock = lock = threading.RLock()  # taken itself for every sample: a condition's methods are Python
        self._sender = Sender(self.writer, demand, passed, post, covered=rooms.covered, pace=self._decided, lock=lock)
        self._wake, self._caught_up = threading.Condition(lock), threading.Condition(lock)
        self._thread = threading.Thread(target=self._run, name="egress", daemon=True)

    def start(self) -> None:
        """Start writing."""
        self._thread.start()
        self._running = True

    def close(self, timeout: float) -> None:
        """Stop writing; what still waits is not sent. Waits at most `timeout` [s] for a put that stalls."""
        self.writer.stop_waiting()
        with self._wake:
            self._open = False
            self._wake.notify()
            self._caught_up.notify_all()
        if self._thread.is_alive():
            self._thread.join(timeout)

    def forward(self, number: int, held: Held) -> None:
        """Send a decided sample as soon as the pace allows, by one thread at a time. It has its place since it came."""
        if self._goes_at_once(held):
            self._sent_at = self._sender.send_decided(number, held)
        elif not self._enqueue(number, held, passes=not held.to and held.key in self._passing_keys):
            self._sender.refuse(number, held)

    def pass_on(self, reason: str, held: Held) -> None:
        """Send a sample at once, counted under `reason`."""
        if self._passes_at_once(held):
            self._sender.send_passing(reason, held)
            return
        room = self._rooms.passing
        behind = len(self._passing)
        if room.crowded or (behind and behind % (TUNING.passing_backlog + 1) == 0):
            self._let_catch_up(held)
            if room.crowded and held.waits:
                self._slow_down()
            if self._passes_at_once(held):
                self._sender.send_passing(reason, held)
                return
        if not room.enter(held.size):
            self._passed.add(FULL, 0)
        elif not self._enqueue(reason, held, passes=held.key not in self._deciding_keys):
            room.leave(held.size)
            self._passed.add(EGRESS, 0)

    def _passes_at_once(self, held: Held) -> bool:
        """Whether a passing sample need wait neither for others nor for a link."""
        # Read in this order: a sample leaves the queue only when the thread is busy with it. So none is overtaken.
        if not self._open or self._passing or self._busy or held.key in self._deciding_keys:
            return False
        return self.buffers.takes(held.size)

    def _goes_at_once(self, held: Held) -> bool:
        """Whether a decided sample need wait for nothing: neither for its pace, nor for others, nor for a link."""
        with self._lock:
            ready = self._running and self._open and not self._deciding
            ready = ready and self._decided.free(clock.monotonic(), self._sender.on_air(held))
            ready = ready and (bool(held.to) or held.key not in self._passing_keys)
        return ready and self.writer.calm and self.buffers.takes(held.size)

    def pace(self, rate: float | None) -> None:
        """Send what was decided no faster than this [B/s] from now on; None: as fast as it goes."""
        with self._wake:
            self._decided.pace(rate)
            self._wake.notify()

    @property
    def waiting(self) -> dict[str, int]:
        """What waits: samples decided, samples passing."""
        return {"decided": len(self._decided), "passing": len(self._passing)}

    @property
    def stands(self) -> bool:
        """Whether the mesh takes nothing: nobody is held up for its sake then."""
        return not self.buffers.clear and self._still_since(self._sent_at)

    def _still_since(self, since: float) -> bool:
        """Whether the sample in hand takes too long already, if it was begun then."""
        return clock.monotonic() - since > TUNING.moving * (1 + self._in_hand // 65536)

    def _let_catch_up(self, held: Held) -> None:
        """Wait a moment until the thread has caught up with all, if that helps: the next sample needs no thread then.

        So it is where links have little room, too: two threads took turns for each sample, and such of 64 B crossed at
        50 to 58 % of a router's rate, and cross at 65 to 70. Nobody waits for a mesh that stands still.
        """
        most = 0 if len(self._passing) > TUNING.passing_backlog else TUNING.passing_backlog
        if not self.buffers.clear and (not held.waits or self._still_since(self._sent_at)):
            return
        with self._wake:
            self._awaited = most
            self._caught_up.wait_for(
                lambda: len(self._passing) <= most and not self._rooms.passing.crowded,
                TUNING.catch_up * (1 + held.size // 65536),
            )

    def _slow_down(self) -> None:
        """Wait for room, as long as the mesh moves: whoever publishes rather waits than loses a sample."""
        room, began = self._rooms.passing, clock.monotonic()
        with self._wake:
            if self._slowed >= TUNING.slowed:
                return
            self._slowed += 1
            while self._open and room.crowded and not (self.stands or self._still_since(max(began, self._sent_at))):
                self._caught_up.wait(TUNING.moving)
            self._slowed -= 1

    def _enqueue(self, number: int | str, held: Held, *, passes: bool) -> bool:
        """Let a sample wait: a decided one with its number, a passing one with its reason."""
        with self._lock:
            if not self._open:
                return False
            if len(self._passing) + len(self._decided) > TUNING.few_held or held.shared:
                held = held.apart
            if passes:
                self._passing.append((number, held))
            else:
                self._decided.put(number, held, self._sender.on_air(held))
            if not held.to:
                (self._passing_keys if passes else self._deciding_keys)[held.key] += 1
            if not self._busy:
                self._wake.notify()
            return True

    def _run(self) -> None:
        while True:
            with self._wake:
                self._busy = self._deciding = False
                self._caught_up.notify_all()
                while self._open and (pause := self._pause()) != 0.0:
                    self._wake.wait(pause)
                if not self._open:
                    return
                # Decided samples first when their time has come: they are paced and starve nobody.
                decided = self._decided.take(clock.monotonic())
                self._deciding = decided is not None
                self._busy = not self._deciding
            if decided is None:
                self._send_waiting()
            else:
                self._send(*decided, self._deciding_keys)

    def _send_waiting(self) -> None:
        """Send what passes, until nothing waits or a decided sample comes first."""
        while self._open and self._passing and not self._decided.ripe(clock.monotonic()):
            self._send(*self._passing.popleft(), self._passing_keys)
            self._sent_at = clock.monotonic()
            caught_up = 0 < len(self._passing) <= self._awaited
            if caught_up or (self._slowed and not self._rooms.passing.crowded):
                self._awaited = 0
                with self._wake:
                    self._caught_up.notify_all()

    def _send(self, number: int | str, held: Held, waiting: Counter[str]) -> None:
        """Send what waited, one of the keys `waiting`."""
        if isinstance(number, str):
            self._rooms.passing.leave(held.size)
            self._sender.send_passing(number, held, droppable=self._wait(held))
        else:
            self._sent_at = self._sender.send_decided(number, held, droppable=self._wait(held))
        if not held.to:
            with self._lock:
                waiting[held.key] -= 1
                if not waiting[held.key]:
                    del waiting[held.key]

    def _pause(self) -> float | None:
        """How long nothing can be sent [s]; None: until something comes."""
        if self._passing:
            return 0.0
        due, now = self._decided.due(), clock.monotonic()
        if due is None:
            return None
        if due > now and now >= self._sent_at + TUNING.idle_check and self.buffers.idle:
            self._decided.catch_up(now)
            return 0.0
        return max(min(due - now, TUNING.idle_check), 0.0)

    def _wait(self, held: Held) -> bool:
        """Wait until links take a sample; whether it may be dropped on those that have no room for it."""
        self._in_hand = held.size
        return self.writer.wait(held)
