"""The shared medium: everything the robots say to each other goes through here, in one queue and at one rate.

There is one port per pair of nodes. Whoever dials it is connected on to the other node of the pair. What
arrives is read in chunks of at most 4 kB; all chunks of all connections, in both directions, wait in one
queue in the order of arrival and are served from one token bucket. A direction has at most one chunk here,
waiting or just served, and its sockets' buffers are small: so what exceeds the rate waits with its sender, as
it does before a radio.
"""

import argparse
import errno
import json
import selectors
import socket
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from studies.demo import cue
from studies.demo.bucket import Bucket

CHUNK = 4096
"""What is served at once, at most [B]."""
BUFFER = 32 * 1024
"""SO_SNDBUF and SO_RCVBUF of every socket of the medium [B]."""
DEPTH = 3 * CHUNK
"""Depth of the token bucket [B]: what may be caught up when the process was not scheduled for a moment."""
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
    served: bool = False
    """The chunk has been on the air; what is left of it waits for room at the receiver."""


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
    """Carries what arrives at its ports at `rate` [B/s], as long as `step` is called."""

    def __init__(self, rate: float, log: Log) -> None:
        now = time.monotonic()
        self._bucket = Bucket(rate, DEPTH, now)
        self._log = log
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

    @property
    def backlog(self) -> int:
        """Bytes that wait here, the sockets' buffers aside."""
        return sum(len(way.chunk) for link in self._links for way in link.ways)

    @property
    def connections(self) -> int:
        """How many connections reach from end to end."""
        return len(self._links)

    def step(self, patience: float) -> None:
        """Wait for the next thing to do, at most `patience` seconds, and do it."""
        for key, events in self._selector.select(min(patience, self._next_due(time.monotonic()))):
            key.data(events)
        now = time.monotonic()
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
        if events & selectors.EVENT_WRITE and back.served:
            self._deliver(link, back)
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
                way.served = True
                self._deliver(link, way)
            self._queue.popleft()

    def _deliver(self, link: Link, way: Way) -> None:
        """Hand a served chunk to its receiver; what that has no room for holds up this direction only."""
        try:
            way.chunk = way.chunk[way.writes.send(way.chunk) :]
        except BlockingIOError:
            return
        except ConnectionError:
            self._hang_up(link)
            return
        way.served = bool(way.chunk)
        self._watch(link)

    def _watch(self, link: Link) -> None:
        """Read only where no chunk is here already; write only where one was served and did not fit."""
        for way, back in (link.ways, reversed(link.ways)):
            events = (0 if way.chunk else selectors.EVENT_READ) | (selectors.EVENT_WRITE if back.served else 0)
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
    """Open one port per pair, say which, and carry until told to stop."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rate", type=float, required=True, help="rate of the medium [bit/s]")
    parser.add_argument("--pair", action="append", required=True, help="DIALER,TARGET,PORT of the target on localhost")
    parser.add_argument("--log", type=Path, required=True, help="file for one line of JSON per served chunk")
    arguments = parser.parse_args()
    stop = cue.stop_on_signal()
    with arguments.log.open("w") as log:

        def note(t: float, source: str, sink: str, size: int) -> None:
            log.write(json.dumps({"event": "serve", "t": t, "source": source, "sink": sink, "size": size}) + "\n")

        relay = Relay(arguments.rate / 8, note)
        pairs = [pair.split(",") for pair in arguments.pair]
        ports = [relay.listen(dialer, target, ("127.0.0.1", int(port))) for dialer, target, port in pairs]
        cue.ready(ports=ports)
        while not stop.is_set():
            relay.step(0.2)
        relay.close()


if __name__ == "__main__":
    main()
