"""A daemon ends at once when it is asked to, in whatever state the mesh is."""

import signal

import pytest

from proxy import exit_codes
from tests.waiting import wait_until

pytestmark = pytest.mark.system

SOON = 4.0
"""On two cores that do other things, too: it is a third of a second on idle ones, ten if Zenoh waits for links [s]."""


@pytest.fixture(params=["up", "out of range", "down"])
def robot(request, team):
    """A robot that sends with all its might, over a radio in some state."""
    sending, listening, _ = team()
    heard = listening.hear("bulk")
    sending.say("bulk", size=40_000, rate=20, block=True)
    wait_until(lambda: heard.numbers("bulk"), what="a first sample")
    if request.param == "out of range":
        sending.host.range(within=False)
    if request.param == "down":
        sending.host.radio("down")
    return sending


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_the_daemon_soon(robot, number):
    """SIGTERM and SIGINT end a busy daemon cleanly and soon, also when its mesh is gone."""
    assert robot.stop(number, SOON) == exit_codes.OK
