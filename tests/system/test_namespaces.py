"""Robots on hosts of their own that share a channel: they meet, and samples cross."""

import time
from itertools import product

import pytest

from tests.system.network import RADIO
from tests.system.robots import wait_until_met
from tests.waiting import wait_until

pytestmark = pytest.mark.system


@pytest.mark.parametrize("interface", [RADIO, "auto"])
def test_robots_find_each_other_by_multicast(team, interface):
    """Robots that start together with the default configuration are linked each to each, over the radio."""
    robots = team(interface=interface)
    for robot in robots:
        links = robot.status()["daemon"]["links"]
        others = {other.host.address for other in robots} - {robot.host.address}
        assert {address_of(link["destination"]) for link in links} == others
        assert {address_of(link["source"]) for link in links} == {robot.host.address}


def address_of(locator):
    """The address in `tcp/10.77.0.1:7500`."""
    return locator.partition("/")[2].rpartition(":")[0]


def test_a_sample_arrives_exactly_once_everywhere(team):
    """Every sample of every robot reaches each application on each robot once and in order; nothing is echoed."""
    robots = team()
    keys = [f"chat/{robot.name}" for robot in robots]
    listeners = [robot.hear("chat/**") for robot in robots]
    for robot, key in zip(robots, keys, strict=True):
        robot.wait_wanted(key)  # what is said before is nothing to the daemon, and not counted
    speakers = [robot.say(key, size=100, rate=50) for robot, key in zip(robots, keys, strict=True)]
    for listener, key in product(listeners, keys):
        wait_until(lambda listener=listener, key=key: len(listener.numbers(key)) >= 50, what=f"50 samples of {key}")
    totals = {key: speaker.stop() for key, speaker in zip(keys, speakers, strict=True)}
    for listener, key in product(listeners, keys):
        last = totals[key] - 1
        wait_until(lambda listener=listener, key=key, last=last: last in listener.numbers(key), what="the last sample")
    for robot, key in zip(robots, keys, strict=True):
        # More would mean that what came from the mesh came in again.
        assert_conserved(robot, totals[key])
    for listener, key in product(listeners, keys):
        heard = listener.numbers(key)
        # An application that starts may miss what was said before it was known.
        assert heard == list(range(heard[0], totals[key]))


def test_a_covered_stream_is_thinned_to_the_limit(team):
    """What robots put on the air for a stream, in all copies, stays below its limit; its own robot misses nothing."""
    limit, window = 50_000, 0.5
    robots = team(limit="400 kbit/s")
    key = "robot/a/camera"
    local, *remote = (robot.hear(key) for robot in robots)
    robots[0].wait_subscribed(key)
    robots[0].wait_wanted(key)
    speaker = robots[0].say(key, size=5000, rate=40)
    wait_until(lambda: all(listener.numbers(key) for listener in remote), what="the first sample")
    began, before = time.monotonic(), sum(robot.host.sent() for robot in robots)
    wait_until(lambda: all(len(listener.numbers(key)) >= 25 for listener in remote), 30, "25 samples")
    on_air, elapsed = sum(robot.host.sent() for robot in robots) - before, time.monotonic() - began
    total = speaker.stop()
    # A limit counts what Zenoh is given, the digests too; headers below that, and acknowledgements, add less than 10 %.
    assert 0.5 * limit * elapsed < on_air < 1.1 * limit * (elapsed + window)
    wait_until(lambda: local.numbers(key) == list(range(total)), what="every sample on its own robot")
    for listener in remote:
        assert listener.numbers(key) == sorted(set(listener.numbers(key)))
    assert_conserved(robots[0], total)
    for robot in robots[1:]:
        assert_conserved(robot, 0)


def assert_conserved(robot, total):
    """Every sample published on the robot is accounted for, once."""
    wait_until(lambda: robot.status()["counts"]["in"] == total, what=f"{total} samples counted by {robot.name}")
    counts = robot.status()["counts"]
    assert counts["conserved"]
    assert counts["forwarded"] + counts["dropped"] + counts["queued"] == total
    assert sum(counts["by_reason"].values()) == total - counts["queued"]


def test_robots_with_a_router_between_them_meet_by_name(start, network):
    """Multicast stays on its side of a routed hop; a named endpoint crosses it, and with it everything."""
    near = start("a")
    dial = ("--mesh.connect", f'["tcp/{near.host.address}:7500"]')
    far = start("b", host=network.add_beyond("b"), options=dial)
    for robot in (near, far):
        wait_until(robot.serves, what=f"start of {robot.name}")
    wait_until_met([near, far])
    for there, here in ((near, far), (far, near)):
        assert_all_cross(there, here)


def assert_all_cross(there, here):
    """All that an application on one robot says, another on the other hears."""
    key = f"from/{there.name}"
    listener = here.hear(key)
    speaker = there.say(key, size=2000, rate=50)
    wait_until(lambda: listener.numbers(key), what="samples")
    total = speaker.stop()
    wait_until(lambda: listener.numbers(key)[-1] == total - 1, what="the last one")
