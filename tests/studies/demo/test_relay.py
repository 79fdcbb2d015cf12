"""The shared medium, with real sockets."""

import socket
import threading
import time
from contextlib import ExitStack, closing, suppress

import pytest

from studies.demo import relay as relay_module
from studies.demo.air import Air
from studies.demo.relay import BUFFER, CHUNK, DEPTH, Relay
from tests.ports import free_port
from tests.waiting import wait_until

SLOW = 20_000.0
"""A rate at which a chunk takes long enough to see the queue [B/s]."""


class Medium:
    """A relay with one target per dialer; the test itself steps it."""

    def __init__(self, rate, stack):
        self.served = []
        self.stack = stack
        self.relay = Relay(Air(rate), lambda *entry: self.served.append(entry))
        stack.enter_context(closing(self.relay))

    def pair(self, name):
        """Dial a new target through the medium; return both ends."""
        server = self.stack.enter_context(socket.create_server(("127.0.0.1", 0)))
        port = self.relay.listen(name, f"{name}-target", server.getsockname())
        near = self.stack.enter_context(socket.create_connection(("127.0.0.1", port)))
        known = self.relay.connections
        self.step_until(lambda: self.relay.connections == known + 1, "the connection")
        return near, self.stack.enter_context(server.accept()[0])

    def step_until(self, condition, what):
        """Step the relay until the condition holds."""

        def step():
            self.relay.step(0.01)
            return condition()

        wait_until(step, what=what)

    def order(self):
        """Return the sources of what was served, in order."""
        return [source for _, source, _, _ in self.served]


@pytest.fixture
def make_medium():
    """Make mediums that are closed after the test."""
    with ExitStack() as stack:
        yield lambda rate: Medium(rate, stack)


class Clock:
    """A clock that the test sets."""

    now = 100.0

    def monotonic(self):
        return self.now


def test_the_medium_carries_its_rate_and_no_more(make_medium, monkeypatch):
    """Two greedy senders together get the rate, within a few percent, and no moment exceeds the bucket."""
    rate, clock = 400_000.0, Clock()
    monkeypatch.setattr(relay_module, "time", clock)
    medium = make_medium(rate)
    pairs = [medium.pair("a"), medium.pair("b")]
    total = 600_000
    for near, far in pairs:
        threading.Thread(target=near.sendall, args=(bytes(total),), daemon=True).start()
        threading.Thread(target=drain, args=(far,), daemon=True).start()

    while sum(size for *_, size in medium.served) < total:
        # The clock stands still for whoever was not scheduled: greedy senders always have something to send.
        medium.step_until(lambda: len(medium.relay._queue) == 2, "something of both")
        clock.now += 0.005
        medium.relay.step(0.0)
    times = [t for t, *_ in medium.served]
    carried = sum(size for *_, size in medium.served)
    lasted = times[-1] - times[0]
    assert carried <= DEPTH + lasted * rate + CHUNK
    assert (carried - DEPTH) / lasted == pytest.approx(rate, rel=0.05)
    shares = [medium.order().count(name) / len(medium.served) for name in ("a", "b")]
    assert shares == pytest.approx([0.5, 0.5], abs=0.05)
    for near, _ in pairs:
        near.shutdown(socket.SHUT_RDWR)


def test_chunks_of_all_connections_are_served_in_the_order_of_arrival(make_medium, monkeypatch):
    """Both directions of every pair wait in one queue."""
    clock = Clock()
    monkeypatch.setattr(relay_module, "time", clock)
    medium = make_medium(SLOW)
    ends = {name: medium.pair(name) for name in ("a", "b", "c")}
    ends["a"][0].sendall(bytes(DEPTH))
    medium.step_until(lambda: sum(size for *_, size in medium.served) == DEPTH, "the bucket to be empty")
    medium.served.clear()
    for name, end in (("c", 0), ("a", 1), ("b", 0), ("a", 0)):
        waiting = medium.relay.backlog
        ends[name][end].sendall(bytes(1000))
        medium.step_until(lambda waiting=waiting: medium.relay.backlog == waiting + 1000, "the arrival")
    clock.now += 4000 / SLOW
    medium.step_until(lambda: len(medium.served) == 4, "the queue to be served")
    assert medium.order() == ["c", "a-target", "b", "a"]
    assert ends["a"][0].recv(2000) == bytes(1000)


def test_what_exceeds_the_rate_waits_with_the_sender(make_medium):
    """The medium holds one chunk per direction, and a sender can hide no more than the sockets' buffers."""
    medium = make_medium(SLOW)
    near, _far = medium.pair("a")
    near.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, BUFFER)
    near.setblocking(False)
    accepted = 0
    quiet_since = time.monotonic()
    while time.monotonic() - quiet_since < 0.1:
        medium.relay.step(0.0)
        assert medium.relay.backlog <= CHUNK
        try:
            accepted += near.send(bytes(CHUNK))
            quiet_since = time.monotonic()
        except BlockingIOError:
            continue
        if accepted > 100 * BUFFER:
            break
    # The kernel doubles both buffers; the bucket let its depth pass; the rest trickled through meanwhile.
    assert accepted - sum(size for *_, size in medium.served) <= 4 * BUFFER + CHUNK


def test_a_receiver_that_does_not_read_holds_up_only_its_own_direction(make_medium):
    """The other pairs go on at full rate."""
    medium = make_medium(1e7)
    stuck, _unread = medium.pair("stuck")
    threading.Thread(target=send_until_closed, args=(stuck,), daemon=True).start()

    def full():
        return any(way.stuck for link in medium.relay._links for way in link.ways)

    medium.step_until(full, "the unread pair to fill up")
    near, far = medium.pair("free")
    near.sendall(b"hello")
    medium.step_until(lambda: "free" in medium.order(), "the other pair to be served")
    assert far.recv(10) == b"hello"
    stuck.shutdown(socket.SHUT_RDWR)


def test_the_target_is_tried_until_it_listens(make_medium):
    """Who dials first does not lose."""
    medium = make_medium(1e6)
    address = ("127.0.0.1", free_port())
    port = medium.relay.listen("a", "late", address)
    near = medium.stack.enter_context(socket.create_connection(("127.0.0.1", port)))
    near.sendall(b"hello")
    for _ in range(20):
        medium.relay.step(0.01)
    assert medium.relay.connections == 0
    late = medium.stack.enter_context(socket.create_server(address))
    medium.step_until(lambda: medium.served, "the late target to be reached")
    far = medium.stack.enter_context(late.accept()[0])
    assert far.recv(10) == b"hello"


def test_a_dialer_that_gives_up_is_forgotten(make_medium):
    """Its target is not dialled for it any more."""
    medium = make_medium(1e6)
    address = ("127.0.0.1", free_port())
    port = medium.relay.listen("a", "late", address)
    socket.create_connection(("127.0.0.1", port)).close()
    for _ in range(20):
        medium.relay.step(0.01)
    with socket.create_server(address) as late:
        late.settimeout(0.2)
        for _ in range(20):
            medium.relay.step(0.01)
        with pytest.raises(TimeoutError):
            late.accept()


@pytest.mark.parametrize("leaver", [0, 1])
def test_when_one_end_hangs_up_so_does_the_other(make_medium, leaver):
    """A robot that leaves is gone for its peer too, and its pair can be dialled again."""
    medium = make_medium(1e6)
    ends = medium.pair("a")
    ends[leaver].close()
    medium.step_until(lambda: medium.relay.connections == 0, "the hanging up")
    assert ends[1 - leaver].recv(1) == b""


def test_what_is_served_arrives_when_its_latency_is_over(make_medium, monkeypatch):
    """Not before, in its order, and what follows is served meanwhile."""
    clock = Clock()
    monkeypatch.setattr(relay_module, "time", clock)
    medium = make_medium(1e6)
    near, far = medium.pair("a")
    far.setblocking(False)
    medium.relay.change(Air(1e6, latency=0.5))
    near.sendall(b"first")
    medium.step_until(lambda: len(medium.served) == 1, "the first to be served")
    clock.now += 0.3
    near.sendall(b"second")
    medium.step_until(lambda: len(medium.served) == 2, "the second to be served")
    with pytest.raises(BlockingIOError):
        far.recv(20)
    clock.now += 0.3
    medium.step_until(lambda: medium.relay.backlog == len(b"second"), "the first to arrive")
    assert far.recv(20) == b"first"
    clock.now += 0.3
    medium.step_until(lambda: medium.relay.backlog == 0, "the second to arrive")
    assert far.recv(20) == b"second"


def test_what_is_lost_is_carried_again(make_medium):
    """It takes room on the air each time, and all arrives in its order."""
    medium = make_medium(1e7)
    near, far = medium.pair("a")
    medium.relay.change(Air(1e7, loss=0.4))
    data = bytes(range(256)) * 80
    threading.Thread(target=near.sendall, args=(data,), daemon=True).start()
    received = bytearray()
    far.setblocking(False)

    def all_there():
        with suppress(BlockingIOError):
            received.extend(far.recv(65536))
        return len(received) == len(data)

    medium.step_until(all_there, "all to arrive")
    assert received == data
    assert sum(size for *_, size in medium.served) > len(data)


def test_the_rate_changes_while_it_runs(make_medium, monkeypatch):
    """What waits is served at the new rate."""
    clock = Clock()
    monkeypatch.setattr(relay_module, "time", clock)
    medium = make_medium(SLOW)
    near, _far = medium.pair("a")
    near.sendall(bytes(DEPTH))
    medium.step_until(lambda: sum(size for *_, size in medium.served) == DEPTH, "the bucket to be empty")
    near.sendall(bytes(CHUNK))
    medium.step_until(lambda: medium.relay.backlog == CHUNK, "the chunk")
    medium.relay.change(Air(100 * SLOW))
    medium.relay.step(0.0)
    clock.now += CHUNK / SLOW / 50
    medium.step_until(lambda: medium.relay.backlog == 0, "the chunk to be served")


def drain(sock):
    """Read until the other end closes."""
    try:
        while sock.recv(65536):
            pass
    except OSError:
        return


def send_until_closed(sock):
    """Send for ever."""
    try:
        while True:
            sock.sendall(bytes(CHUNK))
    except OSError:
        return
