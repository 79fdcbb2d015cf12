"""Applications of one robot hear each other at once, whatever state the mesh is in."""

import pytest

from tests.waiting import wait_until

pytestmark = pytest.mark.system

LATE = 0.5
"""No local sample may take this long [s]; it takes milliseconds."""
RATE = 50
"""Local samples a second."""


@pytest.fixture(params=[False, True], ids=["drop", "block"])
def saturated(request, team):
    """A robot whose applications say much more than its radio carries, in samples that may be dropped or not."""
    robot, listening, _ = team()
    robot.host.slow_down("200kbit")
    heard = listening.hear("bulk")
    speaker = robot.say("bulk", size=40_000, rate=10, block=request.param)
    wait_until(lambda: heard.numbers("bulk"), 30, "a first sample over the slow radio")
    yield robot
    assert len(heard.numbers("bulk")) < speaker.stop() / 2, "the radio was not too slow"


def test_a_slow_mesh_delays_nothing_local(saturated):
    """While the radio is saturated local samples arrive at once, all of them."""
    exchange(saturated, 5 * RATE)


def test_a_dead_mesh_delays_nothing_local(saturated):
    """Nor does a radio that dies under load delay local samples, before or after the others are given up."""
    saturated.host.radio("down")
    exchange(saturated, 5 * RATE)
    wait_until(lambda: saturated.peers() == set(), what="the others to be given up")


def exchange(robot, count):
    """Let two applications of `robot` exchange so many samples, and check that all come and none is late."""
    listener = robot.hear("local")
    robot.wait_subscribed("local")
    speaker = robot.say("local", size=1000, rate=RATE, block=True)
    wait_until(lambda: len(listener.numbers("local")) >= count, 3 * count / RATE, f"{count} local samples")
    total = speaker.stop()
    wait_until(lambda: len(listener.numbers("local")) == total, what=f"all {total} local samples")
    assert listener.numbers("local") == list(range(total))
    assert max(sample["heard"] - sample["sent"] for sample in listener.heard("local")) < LATE


def test_a_large_sample_takes_its_time(team):
    """One of 1 MB needs 2.7 s of a radio with 3 Mbit/s, as between routers: no link is given up for that."""
    robot, listening, _ = team()
    robot.host.slow_down("3mbit")
    heard = listening.hear("map")
    robot.wait_wanted("map")
    robot.say("map", size=1_000_000, rate=0.2, block=True)
    wait_until(lambda: len(heard.numbers("map")) >= 2, 30, "two large samples")
    assert heard.numbers("map")[:2] == [0, 1]
    assert "left the mesh" not in robot.log()
