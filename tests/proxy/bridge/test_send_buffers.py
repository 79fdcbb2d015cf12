"""The links of a session are asked whether they take more, and a full one says no before anybody waits."""

import os
import signal
import subprocess
import sys
from contextlib import ExitStack

import pytest
import zenoh

from proxy.bridge.send_buffers import SendBuffers
from proxy.bridge.sessions import mesh_options, open_session
from proxy.bridge.sockets import links_of
from tests.proxy.nodes import closing, free_endpoint, plain_session
from tests.waiting import wait_until

LISTEN = """
import sys, zenoh
config = zenoh.Config.from_json5('{connect: {endpoints: ["%s"]}, scouting: {multicast: {enabled: false}}}')
with zenoh.open(config) as session:
    subscriber = session.declare_subscriber("**", zenoh.handlers.RingChannel(1))
    print("ready", flush=True)
    sys.stdin.read()
"""


@pytest.fixture(params=["127.0.0.1", "[::1]"])
def mesh(request, stack):
    endpoint = free_endpoint().replace("127.0.0.1", request.param)
    options = mesh_options([endpoint], [], scouting=False, interface="auto", zenoh_options={})
    return closing(stack, open_session(options, "mesh")), endpoint


@pytest.fixture
def listener(mesh):
    """A peer in a process of its own, which can be frozen."""
    with ExitStack() as ending:
        process = subprocess.Popen(
            [sys.executable, "-c", LISTEN % mesh[1]], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        ending.callback(process.wait)
        ending.callback(process.kill)
        for pipe in (process.stdin, process.stdout):
            ending.callback(pipe.close)
        assert process.stdout.readline() == "ready\n"
        yield process


def linked(buffers, links):
    buffers.refresh()
    return buffers.slow()[1] == links


def test_without_links_anything_goes(mesh):
    """Nobody waits for nobody."""
    assert SendBuffers(mesh[0]).takes(1_000_000_000)


def test_a_link_takes_a_part_of_its_buffer(stack, mesh):
    """What is taken is accounted for; links that end are forgotten."""
    buffers = SendBuffers(mesh[0])
    peer = closing(stack, plain_session("peer", connect=(mesh[1],)))
    wait_until(lambda: linked(buffers, 1), what="the link")
    assert buffers.takes(40_000)
    assert not buffers.takes(1_000_000)
    assert buffers.slow() == (0, 1)
    assert buffers.clear
    wait_until(lambda: buffers.idle, what="the end of what links say first")
    assert buffers.alone
    closing(stack, plain_session("peer", connect=(mesh[1],)))
    wait_until(lambda: linked(buffers, 2), what="the other link")
    assert not buffers.alone
    peer.close()
    wait_until(lambda: linked(buffers, 1), what="the end of the link")
    assert buffers.alone


def test_a_peer_that_stops_reading_is_noticed_before_anybody_waits(mesh, listener):
    """Publications that may not be dropped all return while there is room, and there is none in the end."""
    session, _ = mesh
    buffers = SendBuffers(session)
    wait_until(lambda: linked(buffers, 1), what="the link")
    publisher = session.declare_publisher("k", congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: publisher.matching_status.matching, what="the subscription")
    os.kill(listener.pid, signal.SIGSTOP)

    def full():
        while buffers.takes(1000):
            publisher.put(b"x" * 1000)
        return buffers.slow() == (1, 1) and not buffers.idle

    wait_until(full, what="an end of the room")
    os.kill(listener.pid, signal.SIGCONT)
    wait_until(lambda: buffers.takes(1000), what="room again")


def test_a_link_whose_socket_cannot_be_found_counts_as_full(stack):
    """Who listens on UDP has one socket for all links, which tells nothing of any."""
    endpoint = free_endpoint().replace("tcp", "udp")
    mesh = closing(stack, plain_session("peer", listen=(endpoint,)))
    buffers = SendBuffers(mesh)
    closing(stack, plain_session("peer", connect=(endpoint,)))
    # A peer is listed before its link is, and a link before Zenoh says that it is new.
    wait_until(lambda: buffers.refresh() or not buffers.takes(1), what="the link")
    assert len(links_of(mesh)) == 1
    assert not buffers.clear


@pytest.mark.usefixtures("listener")
def test_a_link_tells_what_was_sent(mesh):
    """Every byte that was published, and what it comes with; nothing of links without room, or that are gone."""
    session, _ = mesh
    buffers = SendBuffers(session)
    wait_until(lambda: linked(buffers, 1), what="the link")
    publisher = session.declare_publisher("k", congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: publisher.matching_status.matching, what="the subscription")
    ((peer, before),) = buffers.sent().items()
    assert peer == str(*session.info.peers_zid())
    publisher.put(b"x" * 30_000)
    wait_until(lambda: buffers.sent().get(peer, 0) >= before + 30_000, what="all of it")
    assert buffers.sent()[peer] < before + 40_000
    session.close()
    wait_until(lambda: buffers.sent() == {}, what="the end of the link")


@pytest.mark.usefixtures("listener")
def test_a_link_tells_how_long_what_is_sent_now_takes(mesh):
    """Next to nothing while the peer reads; nothing when nothing was sent lately."""
    session, _ = mesh
    buffers = SendBuffers(session)
    wait_until(lambda: linked(buffers, 1), what="the link")
    publisher = session.declare_publisher("k", congestion_control=zenoh.CongestionControl.DROP)
    wait_until(lambda: publisher.matching_status.matching, what="the subscription")

    def wait():
        publisher.put(b"x" * 30_000)
        return dict(buffers.waits()).get(next(iter(map(str, session.info.peers_zid()))), -1.0)

    wait_until(lambda: 0.0 <= wait() < 0.05, what="a free link")
    wait_until(lambda: buffers.waits() == (), what="silence")
