"""The mission that goes on, with real processes."""

import json
import threading

import cv2
import numpy as np
import pytest

from studies.demo.air import Air
from studies.demo.app import open_client
from studies.demo.live import CHANNEL, RED, Mission
from studies.demo.nodes import SHARE, WINDOW, status
from studies.demo.phase import Conditions
from studies.demo.processes import DemoError
from studies.demo.scene import RED as ENOUGH
from studies.demo.scene import red_fraction
from tests.waiting import wait_until

pytestmark = pytest.mark.full

ROBOTS, RATE = 1, 6e6


@pytest.fixture(scope="module")
def mission(tmp_path_factory):
    """A mission of one robot, into whose way nothing is put but by the tests."""
    folder = tmp_path_factory.mktemp("live")
    conditions = Conditions(ROBOTS, 0.0, RATE, 1, 0.0)
    with Mission(conditions, folder) as going:
        yield going


@pytest.fixture
def session(mission):
    """Another app of the operator, which has come to know who answers there."""
    with open_client(mission.nodes[0].app_endpoint) as opened:
        wait_until(lambda: list(opened.get(CHANNEL, timeout=20.0)), what="who tells of the medium")
        yield opened


def ask(session, key, wanted=None):
    """Ask for what is there, or for what is wanted; return the answer, or the error as text."""
    payload = None if wanted is None else json.dumps(wanted)
    (reply,) = session.get(key, payload=payload, timeout=20.0)
    return json.loads(bytes(reply.ok.payload)) if reply.ok else bytes(reply.err.payload).decode()


def test_the_medium_is_told_and_changed(mission, session):
    """What is not said stays; the limit of the daemons follows."""
    assert ask(session, CHANNEL) == {"limit": RATE / 8, "latency": 0.0, "loss": 0.0}
    assert ask(session, CHANNEL, {"limit": 300_000, "latency": 0.01}) == {"limit": 3e5, "latency": 0.01, "loss": 0.0}
    assert mission.air == Air(3e5, 0.01)

    def followed():
        return status(mission.nodes[1])["budget"][0]["limit"] == pytest.approx(
            SHARE * 3e5 * WINDOW, rel=0.05
        )  # a little is kept back

    wait_until(followed, what="the new limit")


@pytest.mark.parametrize(
    ("key", "wanted", "words"),
    [
        (CHANNEL, {"loss": 7}, "loss: 7 is not from 0 to 1"),
        (CHANNEL, {"speed": 7}, "speed: unknown; a channel has limit, latency, loss"),
        (RED, {"robot": "r9"}, "robot: 'r9' is none of r1"),
        (RED, {"robots": ["r1"]}, 'something red is put into a way with {"robot": name}'),
        (RED, [], 'something red is put into a way with {"robot": name}'),
    ],
)
def test_what_makes_no_sense_is_answered_with_an_error(session, key, wanted, words):
    """It names the key."""
    assert ask(session, key, wanted) == words


def test_something_red_is_put_into_a_way_and_seen(session):
    """The robot's camera shows it to the operator; before, it did not."""
    seen = []

    def look(sample):
        seen.append(red_fraction(cv2.imdecode(np.frombuffer(bytes(sample.payload), np.uint8), cv2.IMREAD_COLOR)))

    with session.declare_subscriber("robot/r1/camera", look):
        wait_until(lambda: seen, what="a frame")
        assert max(seen) < ENOUGH
        assert ask(session, RED) == {"robots": ["r1"]}
        assert ask(session, RED, {"robot": "r1"}) == {"robots": ["r1"]}
        wait_until(lambda: max(seen) >= ENOUGH, what="something red")


def test_it_goes_on_for_as_long_as_it_shall(mission):
    """And tells what the operator saw; a process that ended ends it."""
    told = []
    mission.run(0.0, told.append)
    assert told
    victim = mission._apps.cameras[0]
    victim.terminate()
    ended = threading.Event()

    def over():
        try:
            mission.run(0.0, told.append)
        except DemoError:
            ended.set()
        return ended.is_set()

    wait_until(over, what="the end")
