"""Who is silent is told by the kernel: a robot whose processor is busy is not."""

import os
import signal
import socket
import subprocess
import sys

import pytest

from proxy import clock
from proxy.bridge.sessions import mesh_options, open_session
from proxy.bridge.silence import Answers, Silence, longest_silence, silent_since
from proxy.bridge.sockets import Sockets
from proxy.bridge.tuning import TUNING
from tests.proxy.nodes import closing, free_endpoint, plain_session
from tests.waiting import wait_until

TX = {"transport": {"link": {"tx": {"lease": 5000}}}}


@pytest.mark.parametrize(
    ("looks", "silent"),
    [
        ([(0.0, (0.1, 7, 0.1)), (1.0, (1.1, 7, 1.1)), (2.0, (2.1, 7, 2.1))], 2.0),
        ([(0.0, (0.1, 7, 0.1)), (1.0, (1.1, 7, 0.2)), (2.0, (2.1, 7, 1.2))], 1.2),
        ([(0.0, (0.1, 7, 0.1)), (1.0, (None, 8, 0.9)), (2.0, (0.9, 8, 1.9))], 0.9),
        ([(0.0, (None, 7, 9.0)), (1.0, (0.2, 7, 10.0)), (1.5, (0.7, 7, 10.5))], 0.7),
        ([(0.0, (None, 7, 9.0)), (1.0, (9.0, 7, 10.0))], 1.0),
        ([(0.0, (None, 7, 0.1)), (1.0, (0.9, 7, 0.3))], 0.3),
        ([(0.0, (0.1, 7, 0.1)), (9.0, (8.9, 8, 8.9))], 0.0),
    ],
    ids=["no answer", "another word", "answered", "asked after long", "not asked before", "heard since", "looked late"],
)
def test_silence_is_not_to_answer(looks, silent):
    """It begins when something was sent that is not answered; who was not asked or looked at, may answer."""
    since, last = looks[0][0], Answers(*looks[0][1])
    for now, this in looks:
        since, last = silent_since(now, since, last, Answers(*this)), Answers(*this)
    assert looks[-1][0] - since == pytest.approx(silent)


ROBOT = """
import sys
from proxy.bridge.sessions import mesh_options, open_session
options = mesh_options([], [sys.argv[1]], scouting=False, interface="auto", zenoh_options={})
with open_session(options, "mesh") as session:
    sys.stdin.read()
"""


@pytest.fixture
def mesh(stack):
    endpoint = free_endpoint()
    options = mesh_options([endpoint], [], scouting=False, interface="auto", zenoh_options={})
    return closing(stack, open_session(options, "mesh")), endpoint


def test_a_robot_that_has_no_processor_is_not_silent(mesh):
    """It stands still for longer than a robot may be silent, and its kernel acknowledges all the same: it stays."""
    session, endpoint = mesh
    silence = Silence(session)
    robot = subprocess.Popen([sys.executable, "-c", ROBOT, endpoint], stdin=subprocess.PIPE)
    try:
        wait_until(session.info.links, what="the link")
        before = [link.dst for link in session.info.links()]
        os.kill(robot.pid, signal.SIGSTOP)
        began = clock.monotonic()

        def waited():
            assert silence.check(clock.monotonic()) > clock.monotonic()
            assert [link.dst for link in session.info.links()] == before
            return clock.monotonic() - began > 1.5 * TUNING.silent_robot

        wait_until(waited, what="more than a robot may be silent")
    finally:
        robot.kill()
        robot.communicate()


def test_a_link_that_is_silent_ends(mesh, stack):
    """At once: Zenoh does not wait for its lease then."""
    session, endpoint = mesh
    closing(stack, plain_session("peer", connect=(endpoint,)))
    wait_until(session.info.links, what="the link")
    ends = {link.dst for link in session.info.links()}

    def ended():
        # Without any patience whoever has something to answer is silent.
        Silence(session, 0.0).check(clock.monotonic())
        return ends.isdisjoint(link.dst for link in session.info.links())

    wait_until(ended, what="its end")


@pytest.mark.parametrize(("longest", "idle"), [(0.5, 1), (2.0, 1), (60.0, 15)])
def test_links_that_are_idle_are_probed_by_the_kernel(mesh, stack, longest, idle):
    """Old and new ones, a few times in what a robot may be silent for; Zenoh says less often that it is alive."""
    session, endpoint = mesh
    silence = Silence(session, longest)

    def all_probed(links):
        silence.check(clock.monotonic())
        return probed(session) == [(1, idle, idle)] * links

    for links in (1, 2):
        closing(stack, plain_session("peer", connect=(endpoint,)))
        wait_until(lambda links=links: all_probed(links), what="the link and its probes")


def probed(session):
    """For each link of a session whether it is probed, when it is idle for how long, and how often after that [s]."""
    sockets = Sockets(session)
    sockets.refresh()
    found = []
    for _, number in sockets.ends:
        borrowed = socket.socket(fileno=number)
        asked = borrowed.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE)
        idle = borrowed.getsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPIDLE)
        found.append((asked, idle, borrowed.getsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPINTVL)))
        borrowed.detach()
    return found


@pytest.mark.parametrize(
    ("listen", "options", "lease", "silent"),
    [("tcp/[::]:0", {}, 10_000, 2.0), ("udp/[::]:0", {}, 2000, 2.0), ("tcp/[::]:0", TX, 5000, 5.0)],
    ids=["TCP", "UDP", "configured"],
)
def test_the_lease_is_long_where_the_kernel_tells_who_is_silent(listen, options, lease, silent):
    """Where it does not, Zenoh has to; who configures a lease says how long a robot may be silent."""
    found = mesh_options([listen], [], scouting=False, interface="auto", zenoh_options=options)
    assert found["transport"]["link"]["tx"]["lease"] == lease
    assert longest_silence(options) == silent
