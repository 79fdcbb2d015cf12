"""The shared medium: everything the robots say to each other goes through here, in one queue and at one rate.

There is one port per pair of nodes. Whoever dials it is connected on to the other node of the pair. What
arrives is read in chunks of at most 4 kB; all chunks of all connections, in both directions, wait in one
queue in the order of arrival and are served from one token bucket. A direction has at most one chunk that waits
here, and its sockets' buffers are small: so what exceeds the rate waits with its sender, as it does before a radio.

Rate, latency and loss may change at any time. What was served is delivered when its latency is over; what was lost is
served once more after a while, and what comes after it in its direction waits for it, as with TCP.
"""

import argparse
import errno
import heapq
import json
import selectors
import socket
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from random import Random

from proxy.priority import raise_priority
from studies.demo import cue
from studies.demo.air import Air
from studies.demo.app import write_log
from studies.demo.bucket import Bucket

CHUNK = 4096
"""What is served at once, at most [B]."""
BUFFER = 32 * 1024
"""SO_SNDBUF and SO_RCVBUF of every socket of the medium [B]."""
DEPTH = 3 * CHUNK
"""Depth of the token bucket [B]: what may be caught up when the process was not scheduled for a moment."""
PACKET = 1448
"""Payload of a packet, which is lost or not [B]."""
RESEND = 0.05
"""What was lost is sent anew after this time and twice the latency [s]."""
RETRY = 0.05
"""Time between attempts to reach a target that does not listen yet [s]."""

Log = Callable[[float, str, str, int], None]
"""Called with the time [s, monotonic], source, sink and size [B] of every chunk that was served."""


@dataclass(slots=True, eq=False)
class Way:
    """One direction of a connection: it reads from one end and writes to the other."""

    source: str
    sink: str
    reads: socket.socket
    writes: socket.socket
    chunk: bytes = b""
    """What waits here to be served, or is lost and waits to be served anew."""
    under_way: deque[tuple[float, bytes]] = field(default_factory=deque)
    """What has been on the air: when it is to be delivered [s], and what."""
    stuck: bool = False
    """What is due waits for room at the receiver."""
    awaited: bool = False
    """Somebody will look when the next is due."""


@dataclass(slots=True, eq=False)
class Link:
    """A connection that was dialled at a port, and its continuation to the target at `address`."""

    dialer: str
    target: str
    address: tuple[str, int]
    near: socket.socket
    ways: tuple[Way, ...] = ()
    """From dialer to target, and back; none until the target was reached and after either end hung up."""
    retry_at: float = 0.0


class Relay:
    """Carries what arrives at its ports as the `air` is, as long as `step` is called. `seed` decides what is lost."""

    def __init__(self, air: Air, log: Log, seed: int = 0) -> None:
        self._air = self._wanted = air
        self._bucket = Bucket(air.limit, DEPTH, time.monotonic())
        self._random = Random(seed)
        self._log = log
        self._delayed: list[tuple[float, int, Callable[[], None]]] = []
        """When something is due, and what; a heap."""
        self._count = 0
        self._selector = selectors.DefaultSelector()
        self._queue: deque[tuple[Link, Way]] = deque()
        self._dialling: list[Link] = []
        self._links: list[Link] = []

    def listen(self, dialer: str, target: str, address: tuple[str, int]) -> int:
        """Open the port at which `dialer` reaches `target`, which listens at `address`; return it."""
        listener = socket.create_server(("127.0.0.1", 0))
        _shrink(listener)
        listener.setblocking(False)

        def accept(_: int) -> None:
            near, _address = listener.accept()
            _prepare(near)
            self._dialling.append(Link(dialer, target, address, near))

        self._selector.register(listener, selectors.EVENT_READ, accept)
        return int(listener.getsockname()[1])

    def change(self, air: Air) -> None:
        """Be as this air from the next step on; may be called by any thread."""
        self._wanted = air

    @property
    def backlog(self) -> int:
        """Bytes that wait here, the sockets' buffers aside."""
        ways = [way for link in self._links for way in link.ways]
        return sum(len(way.chunk) + sum(len(data) for _, data in way.under_way) for way in ways)

    @property
    def connections(self) -> int:
        """How many connections reach from end to end."""
        return len(self._links)

    def step(self, patience: float) -> None:
        """Wait for the next thing to do, at most `patience` seconds, and do it."""
        for key, events in self._selector.select(min(patience, self._next_due(time.monotonic()))):
            key.data(events)
        now = time.monotonic()
        if self._air is not self._wanted:
            self._air = self._wanted
            self._bucket.set_rate(self._air.limit, now)
        while self._delayed and self._delayed[0][0] <= now:
            *_, call = heapq.heappop(self._delayed)
            call()
        self._serve(now)
        for link in [link for link in self._dialling if link.retry_at <= now]:
            self._dial(link, now)

    def close(self) -> None:
        """Close every socket."""
        for link in list(self._links):
            self._hang_up(link)
        for key in list(self._selector.get_map().values()):
            self._selector.unregister(key.fileobj)
            key.fileobj.close()  # type: ignore[union-attr]  # only sockets are registered
        for link in self._dialling:
            link.near.close()
        self._selector.close()

    def _next_due(self, now: float) -> float:
        """Return the time until the next chunk may be served or the next target be tried [s]."""
        due = [max(0.0, link.retry_at - now) for link in self._dialling]
        if self._queue:
            due.append(self._bucket.wait(len(self._queue[0][1].chunk), now))
        if self._delayed:
            due.append(max(0.0, self._delayed[0][0] - now))
        return min(due, default=1.0)

    def _dial(self, link: Link, now: float) -> None:
        """Try to reach the target, which is on this machine: it accepts or refuses at once."""
        if _gone(link.near):
            self._dialling.remove(link)
            link.near.close()
            return
        far = socket.socket()
        _shrink(far)
        if far.connect_ex(link.address):
            far.close()
            link.retry_at = now + RETRY
            return
        _prepare(far)
        self._dialling.remove(link)
        self._links.append(link)
        out = Way(link.dialer, link.target, link.near, far)
        back = Way(link.target, link.dialer, far, link.near)
        link.ways = (out, back)
        self._watch(link)

    def _ready(self, link: Link, way: Way, back: Way, events: int) -> None:
        """Go on at the end that `way` reads from and `back` writes to."""
        if events & selectors.EVENT_WRITE and back.stuck:
            self._deliver(link, back, time.monotonic())
        if events & selectors.EVENT_READ and link.ways:
            self._read(link, way)

    def _read(self, link: Link, way: Way) -> None:
        try:
            way.chunk = way.reads.recv(CHUNK)
        except ConnectionError:
            way.chunk = b""
        if not way.chunk:
            self._hang_up(link)
            return
        self._queue.append((link, way))
        self._watch(link)

    def _serve(self, now: float) -> None:
        """Serve the queue, first come first served, as far as the tokens reach."""
        while self._queue:
            link, way = self._queue[0]
            if link.ways:
                if not self._bucket.take(len(way.chunk), now):
                    return
                self._log(now, way.source, way.sink, len(way.chunk))
                self._carry(link, way, now)
            self._queue.popleft()

    def _carry(self, link: Link, way: Way, now: float) -> None:
        """The chunk has been on the air: it gets through, later or at once, or is lost."""
        air, packets = self._air, -(-len(way.chunk) // PACKET)
        if air.loss and self._random.random() >= (1.0 - air.loss) ** packets:
            self._call_at(now + RESEND + 2.0 * air.latency, lambda: self._queue.append((link, way)))
            return
        due = max(now + air.latency, way.under_way[-1][0] if way.under_way else 0.0)
        way.under_way.append((due, way.chunk))
        way.chunk = b""
        self._deliver(link, way, now)

    def _call_at(self, due: float, call: Callable[[], None]) -> None:
        self._count += 1
        heapq.heappush(self._delayed, (due, self._count, call))

    def _await(self, link: Link, way: Way) -> None:
        """Look again when the next is due."""

        def look() -> None:
            way.awaited = False
            if link.ways:
                self._deliver(link, way, time.monotonic())

        if not way.awaited:
            way.awaited = True
            self._call_at(way.under_way[0][0], look)

    def _deliver(self, link: Link, way: Way, now: float) -> None:
        """Hand what is due to its receiver; what that has no room for holds up this direction only."""
        way.stuck = False
        while way.under_way and way.under_way[0][0] <= now:
            due, data = way.under_way.popleft()
            try:
                sent = way.writes.send(data)
            except BlockingIOError:
                sent = 0
            except ConnectionError:
                self._hang_up(link)
                return
            if sent < len(data):
                way.under_way.appendleft((due, data[sent:]))
                way.stuck = True
                break
        if way.under_way and not way.stuck:
            self._await(link, way)
        self._watch(link)

    def _watch(self, link: Link) -> None:
        """Read only where no chunk waits already and none is stuck; write only where one is."""
        for way, back in (link.ways, reversed(link.ways)):
            reads = not way.chunk and not way.stuck
            events = (selectors.EVENT_READ if reads else 0) | (selectors.EVENT_WRITE if back.stuck else 0)
            known = self._selector.get_map().get(way.reads)
            if known is not None and known.events == events:
                continue
            if known is not None:
                self._selector.unregister(way.reads)
            if events:
                self._selector.register(
                    way.reads, events, lambda events, way=way, back=back: self._ready(link, way, back, events)
                )

    def _hang_up(self, link: Link) -> None:
        """Either end is gone: close both. What waited here is lost, as in a radio that leaves."""
        for way in link.ways:
            if way.reads in self._selector.get_map():
                self._selector.unregister(way.reads)
            way.reads.close()
        link.ways = ()
        self._links.remove(link)


def _shrink(sock: socket.socket) -> None:
    """Make the buffers small before connecting or listening: only then the window follows."""
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, BUFFER)


def _prepare(sock: socket.socket) -> None:
    sock.setblocking(False)
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)


def _gone(sock: socket.socket) -> bool:
    """Whether the other end has hung up."""
    try:
        return not sock.recv(1, socket.MSG_PEEK)
    except BlockingIOError:
        return False
    except OSError as error:
        return error.errno in (errno.ECONNRESET, errno.EPIPE)


def main() -> None:
    """Open one port per pair, say which, and carry until told to stop; hear of another air."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rate", type=float, required=True, help="rate of the medium [bit/s]")
    parser.add_argument("--pair", action="append", required=True, help="DIALER,TARGET,PORT of the target on localhost")
    parser.add_argument("--latency", type=float, default=0.0, help="how long each byte is under way [s]")
    parser.add_argument("--loss", type=float, default=0.0, help="which part of the packets is lost, from 0 to 1")
    parser.add_argument("--log", type=Path, help="file for one line of JSON per served chunk")
    arguments = parser.parse_args()
    stop = cue.stop_on_signal()
    raise_priority()  # as daemons do that may: a radio does not wait for a processor
    with write_log(arguments.log) as log:

        def note(t: float, source: str, sink: str, size: int) -> None:
            if log:
                log.write(json.dumps({"event": "serve", "t": t, "source": source, "sink": sink, "size": size}) + "\n")

        relay = Relay(Air(arguments.rate / 8, arguments.latency, arguments.loss), note)
        pairs = [pair.split(",") for pair in arguments.pair]
        ports = [relay.listen(dialer, target, ("127.0.0.1", int(port))) for dialer, target, port in pairs]
        cue.ready(ports=ports)
        cue.listen(lambda told: relay.change(Air(**told)))
        while not stop.is_set():
            relay.step(0.2)
        relay.close()


if __name__ == "__main__":
    main()
