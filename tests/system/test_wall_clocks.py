"""Robots whose wall clocks are wrong send what they would send with right ones, and say so."""

import pytest

from tests.system.robots import wait_until_met
from tests.system.wall_clock import WallClock, compiled, since_1970
from tests.waiting import wait_until

pytestmark = pytest.mark.system

CLOSE = 0.005
"""What the clock of another robot may be taken for wrong [s]."""
LONGEST = 75.0
"""Robots of which none leads hear of each other at least once a minute [s]."""
SOON = 0.25
"""On a channel without load no sample takes as long [s], even on a busy machine."""
STAMPING = '{ mode: "client", connect: { endpoints: ["tcp/127.0.0.1:7447"] }, timestamping: { enabled: true } }'


@pytest.fixture
def start_at(network, start, tmp_path):
    """Start a robot whose wall clock shows so many seconds more than the machine's."""
    library = compiled(tmp_path)

    def start_one(name, ahead):
        host = network.add(name)
        host.clock = WallClock(library, tmp_path / f"clock-{name}", ahead)
        return start(name, host=host)

    return start_one


def test_wrong_clocks_stop_nothing_and_are_told(start_at, tmp_path):
    """Ten seconds ahead and set back by a minute meanwhile, ten behind, or never set: all is as with right clocks."""
    robots = right, ahead, _, _ = [
        start_at(name, shown) for name, shown in zip("abcd", (0.0, 10.0, -10.0, since_1970()), strict=True)
    ]
    for robot in robots:
        wait_until(robot.serves, what=f"start of {robot.name}")
    wait_until_met(robots)
    setting = tmp_path / "stamping.json5"
    setting.write_text(STAMPING)
    listeners = [robot.hear("robot/*/camera") for robot in robots]
    speakers = [
        robot.say(f"robot/{robot.name}/camera", size=2000, rate=10, setting=setting if robot is ahead else None)
        for robot in robots
    ]
    made = check(robots, listeners, dict.fromkeys("abcd", 0))
    ahead.host.clock.set(-50.0)
    check(robots, listeners, made)
    assert right.log().count("the clock of b is ") == 1, right.log()
    for speaker in speakers:
        speaker.stop()


def check(robots, listeners, made):
    """Samples go on crossing, decisions go on, and each robot knows the clocks and the ways of the others.

    `made` are the decisions that each robot had made before; return those made now.
    """
    counts = [len(listener.heard()) for listener in listeners]
    found = {}
    for robot in robots:
        what = f"right view of {robot.name}"
        wait_until(lambda robot=robot: knows(robot, robots, made[robot.name], found), LONGEST, what)
    keys = {f"robot/{robot.name}/camera" for robot in robots}
    for listener, count in zip(listeners, counts, strict=True):
        wait_until(
            lambda listener=listener, count=count: {sample["key"] for sample in listener.heard()[count:]} == keys,
            what="more samples of everybody",
        )
    return found


def knows(robot, robots, made, found):
    """Whether a robot goes on deciding and knows the clocks of all others, how wrong they are, and what samples take.

    It had made so many decisions; those made now are noted in `found`.
    """
    status = robot.status()
    found[robot.name] = sum(status["decisions"][kind] for kind in ("made", "unneeded", "undisputed", "hopeless"))
    shown = {other.name: other.host.clock.ahead for other in robots}
    return found[robot.name] > made + 5 and all(
        # All hosts share one monotonic clock.
        peer["clock_uncertainty"] is not None
        and abs(peer["clock_offset"]) <= min(CLOSE, peer["clock_uncertainty"])
        and abs(peer["wall_ahead"] - (shown[peer["robot"]] - shown[robot.name])) <= CLOSE
        and all(way is not None and way["fixed"] + 2000 * way["per_byte"] < SOON for way in ways(peer))
        and any(f"the clock of {peer['robot']} is" in warning for warning in status["warnings"])
        for peer in status["peers"]
    )


def ways(peer):
    """What is known of samples from and to a peer."""
    return peer["latency_in"], peer["latency_out"]
