"""Who is silent is told by the kernel: a robot whose processor is busy is not."""

import os
import signal

import pytest

from proxy import clock
from proxy.bridge.sessions import mesh_options
from proxy.bridge.silence import Answers, Silence, longest_silence, silent_since
from tests.proxy.bridge.test_headroom import listener, mesh  # noqa: F401 - fixtures
from tests.proxy.nodes import closing, plain_session
from tests.waiting import wait_until

TX = {"transport": {"link": {"tx": {"lease": 5000}}}}


@pytest.mark.parametrize(
    ("looks", "silent"),
    [
        ([(0.0, (True, 7, 0.1)), (1.0, (True, 7, 1.1)), (2.0, (True, 7, 2.1))], 2.0),
        ([(0.0, (True, 7, 0.1)), (1.0, (True, 7, 0.2)), (2.0, (True, 7, 1.2))], 1.2),
        ([(0.0, (True, 7, 0.1)), (1.0, (False, 8, 0.9)), (2.0, (True, 8, 1.9))], 0.0),
        ([(0.0, (False, 7, 9.0)), (1.0, (True, 7, 10.0)), (1.5, (True, 7, 10.5))], 0.5),
        ([(0.0, (True, 7, 0.1)), (9.0, (True, 8, 8.9))], 0.0),
    ],
    ids=["no answer", "another word", "answered", "asked after long", "looked after long"],
)
def test_silence_is_not_to_answer(looks, silent):
    """It begins with the first look that finds something unanswered; who was not asked or looked at, may answer."""
    since, last = looks[0][0], Answers(*looks[0][1])
    for now, this in looks:
        since, last = silent_since(now, since, last, Answers(*this)), Answers(*this)
    assert looks[-1][0] - since == pytest.approx(silent)


def test_a_peer_that_does_not_run_is_not_silent(mesh, listener):  # noqa: F811 - fixtures
    """It is frozen, and its kernel acknowledges all the same: no link ends, however little patience there is."""
    session, _ = mesh
    silence = Silence(session, 0.2)
    publisher = session.declare_publisher("k")
    wait_until(lambda: publisher.matching_status.matching, what="the subscription")
    os.kill(listener.pid, signal.SIGSTOP)
    began = clock.monotonic()

    def waited():
        publisher.put(b"x")
        silence.check(clock.monotonic())
        return clock.monotonic() - began > 1.0

    wait_until(waited, what="more than its patience")
    assert list(session.info.peers_zid())


def test_a_link_that_is_silent_ends(mesh, stack):  # noqa: F811 - fixtures
    """At once: Zenoh does not wait for its lease then."""
    session, endpoint = mesh
    closing(stack, plain_session("peer", connect=(endpoint,)))
    wait_until(lambda: list(session.info.peers_zid()), what="the link")
    wait_until(session.info.links, what="the link")
    ends = {link.dst for link in session.info.links()}

    def ended():
        # No patience at all: whatever was sent just now is unanswered.
        Silence(session, 0.0).check(clock.monotonic())
        return ends.isdisjoint(link.dst for link in session.info.links())

    wait_until(ended, what="its end")


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
