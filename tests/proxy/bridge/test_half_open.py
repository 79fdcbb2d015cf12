"""Robots of which only one has lost the other meet anew when both have."""

import itertools
import socket
import threading
from contextlib import suppress

import zenoh

from proxy import clock
from proxy.bridge.half_open import HalfOpen
from tests.ports import free_port
from tests.proxy.nodes import Heard, closing, plain_session
from tests.waiting import wait_until

AGAIN = {"period_init_ms": 100, "period_max_ms": 100, "period_increase_factor": 1}


class Relay:
    """A way to a listener, of which each end can go without the other."""

    def __init__(self, stack, port, to):
        self._server = socket.create_server(("127.0.0.1", port))
        self._to = to
        self._ends = []
        self._threads = []
        self._apart = False
        stack.callback(self._close)
        self._start(self._run)

    def end_far(self):
        """Let the listener see its end; whoever dialled does not."""
        self._apart = True
        for _, far in self._ends:
            far.shutdown(socket.SHUT_RDWR)

    def end_all(self):
        """Take no more calls, and end those there are."""
        for each in (self._server, *itertools.chain(*self._ends)):
            with suppress(OSError):  # it has ended already
                each.shutdown(socket.SHUT_RDWR)

    def _close(self):
        self.end_all()
        for thread in self._threads:
            thread.join()
        for each in (self._server, *itertools.chain(*self._ends)):
            each.close()

    def _start(self, run, *arguments):
        thread = threading.Thread(target=run, args=arguments)
        self._threads.append(thread)
        thread.start()

    def _run(self):
        with suppress(OSError):  # nobody is taken any more
            while True:
                near, _ = self._server.accept()
                far = socket.create_connection(("127.0.0.1", self._to))
                self._ends.append((near, far))
                self._start(self._carry, near, far)
                self._start(self._carry, far, near)

    def _carry(self, source, sink):
        with suppress(OSError):  # either end has gone
            while data := source.recv(1 << 16):
                sink.sendall(data)
            if not self._apart:
                sink.shutdown(socket.SHUT_WR)


def tcp(port):
    return f"tcp/127.0.0.1:{port}"


def half_opened(stack):
    """Return two peers that are linked, after only the second lost the first for a moment; and what it sees of it."""
    first, second, way, back = (free_port() for _ in range(4))
    there = Relay(stack, way, second)
    loser = closing(stack, plain_session("peer", listen=(tcp(second),), connect=(tcp(back),), retry=AGAIN))
    keeper = closing(stack, plain_session("peer", listen=(tcp(first),), connect=(tcp(way),)))
    stack.callback(keeper.liveliness().declare_token("token/keeper").undeclare)
    seen = Seen(loser)
    wait_until(lambda: seen.alive, what="the token")
    return keeper, loser, seen, there, lambda: Relay(stack, back, first)


class Seen:
    """Whether the token is alive as far as its coming and going tells."""

    def __init__(self, session):
        self.alive = False
        self._subscriber = session.liveliness().declare_subscriber("token/*", self._note, history=True)

    def _note(self, sample):
        self.alive = sample.kind == zenoh.SampleKind.PUT


def test_who_kept_its_transport_ends_it_when_its_first_link_goes(stack):
    """Plain peers stay linked, and one never sees the token of the other again; with it they meet anew."""
    keeper, loser, seen, there, open_back = half_opened(stack)
    half_open = HalfOpen(keeper)
    stack.callback(half_open.close)
    there.end_far()
    wait_until(lambda: not loser.info.peers_zid(), what="the loss, at one end")
    assert keeper.info.peers_zid()
    open_back()
    wait_until(lambda: len(keeper.info.links()) == 2, what="the link from the other end")
    half_open.check(clock.monotonic())
    half_open.check(clock.monotonic())
    assert len(keeper.info.links()) == 2, "a second link is nothing to end"
    there.end_all()
    wait_until(lambda: len(keeper.info.links()) == 1, what="the end of the first link")
    heard = Heard(keeper, "sample")
    assert not seen.alive, "this is what Zenoh does; if it does not any more, `HalfOpen` can go"
    wait_until(lambda: half_open.check(clock.monotonic()) or seen.alive, what="the token again")
    wait_until(lambda: loser.put("sample", "x") or heard.samples, what="a sample")


def test_a_link_that_ends_soon_says_nothing(stack):
    """It is one of two that were dialled at once, and the other one is good."""
    keeper, loser, _, there, open_back = half_opened(stack)
    half_open = HalfOpen(keeper, young=60.0)
    stack.callback(half_open.close)
    there.end_far()
    wait_until(lambda: not loser.info.peers_zid(), what="the loss, at one end")
    first = [link.dst for link in keeper.info.links()]
    back = open_back()
    wait_until(lambda: len(keeper.info.links()) == 2, what="the link from the other end")
    back.end_all()
    wait_until(lambda: len(keeper.info.links()) == 1, what="its end")
    for _ in range(3):
        half_open.check(clock.monotonic())
    assert [link.dst for link in keeper.info.links()] == first


def test_links_that_end_with_their_transport_leave_nothing_to_do(stack, caplog):
    """Whoever goes and comes back is left alone."""
    port = free_port()
    keeper = closing(stack, plain_session("peer", listen=(tcp(port),)))
    half_open = HalfOpen(keeper)
    stack.callback(half_open.close)
    caplog.set_level("INFO")
    for _ in range(3):
        with plain_session("peer", connect=(tcp(port),)):
            wait_until(keeper.info.links, what="the link")
            for _ in range(3):
                half_open.check(clock.monotonic())
            assert keeper.info.links()
        wait_until(lambda: half_open.check(clock.monotonic()) or not keeper.info.links(), what="its end")
    assert "half open" not in caplog.text
