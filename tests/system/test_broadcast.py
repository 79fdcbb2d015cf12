"""Robots that broadcast: one transmission of a sample reaches all of them."""

import time

import pytest

from tests.system.test_namespaces import assert_conserved
from tests.waiting import wait_until

pytestmark = pytest.mark.system

BROADCAST = ("--mesh.transport", "broadcast")
SIZE = 40_000
"""Of a large sample, which is 28 frames [B]."""


@pytest.mark.parametrize(
    ("names", "transport", "copies"),
    [("abc", "broadcast", 1), ("abc", "unicast", 2), ("abcdefgh", "broadcast", 1)],
)
def test_one_transmission_reaches_all(team, names, transport, copies):
    """A sample is on the air once however many robots hear it; in unicast once for each of them."""
    speaking, *hearing = robots = team(names, options=("--mesh.transport", transport))
    listeners = [robot.hear("bulk") for robot in hearing]
    for robot in hearing:
        robot.wait_subscribed("bulk")
    speaking.wait_wanted("bulk")
    before = sent(robots)
    speaker = speaking.say("bulk", size=SIZE, rate=10)
    wait_until(lambda: all(len(listener.numbers("bulk")) >= 25 for listener in listeners), what="25 samples")
    total = speaker.stop()
    assert_conserved(speaking, total)

    def on_air():
        return (sent(robots) - before) / total

    wait_until(lambda: on_air() > 0.95 * copies * SIZE, what="all of it on the air")
    print(f"{len(names)} robots, {transport}: {on_air():.0f} B on the air for a sample of {SIZE} B")
    assert on_air() < (copies + 0.4) * SIZE


def test_a_covered_stream_is_thinned_to_the_limit(team):
    """What is on the air of a broadcast stream stays below its limit, whose whole amount reaches every robot."""
    limit, window = 50_000, 0.5
    robots = team(limit="400 kbit/s", options=BROADCAST)
    key = "robot/a/camera"
    local, *remote = (robot.hear(key) for robot in robots)
    robots[0].wait_subscribed(key)
    robots[0].wait_wanted(key)
    speaker = robots[0].say(key, size=5000, rate=40)
    wait_until(lambda: all(listener.numbers(key) for listener in remote), what="the first sample")
    began, before = time.monotonic(), sent(robots)
    wait_until(lambda: all(len(listener.numbers(key)) >= 40 for listener in remote), 30, "40 samples")
    on_air, elapsed = sent(robots) - before, time.monotonic() - began
    total = speaker.stop()
    print(f"{on_air / elapsed:.0f} B/s on the air of {limit}")
    assert 0.7 * limit * elapsed < on_air < 1.1 * limit * (elapsed + window)
    wait_until(lambda: local.numbers(key) == list(range(total)), what="every sample on its own robot")
    for listener in remote:
        assert listener.numbers(key) == sorted(set(listener.numbers(key)))
    assert_conserved(robots[0], total)
    for robot in robots[1:]:
        assert_conserved(robot, 0)
    status = robots[1].status()
    assert (status["transport"], status["coordination"]) == ("broadcast 224.0.0.226:7449", "announce")
    assert {peer["transport"] for peer in status["peers"]} == {"broadcast 224.0.0.226:7449"}
    assert (status["warnings"], status["daemon"]["broadcast"]["heard"]) == ([], 2)


@pytest.mark.parametrize(
    ("vanish", "come_back"),
    [
        (lambda robot: robot.kill(), lambda robot: robot.start()),
        (lambda robot: robot.host.radio("down"), lambda robot: robot.host.radio("up")),
        (lambda robot: robot.host.range(within=False), lambda robot: robot.host.range(within=True)),
    ],
    ids=["killed", "radio off", "out of range"],
)
def test_a_robot_that_comes_back_hears_and_is_heard(team, vanish, come_back):
    """A robot that was killed, or whose radio was off, takes part in the broadcast again; nobody else notices."""
    lost, *others = robots = team(options=BROADCAST)
    vanish(lost)
    wait_until(lambda: lost.name not in others[0].peers(), what="the loss")
    come_back(lost)
    wait_until(lost.serves, what=f"start of {lost.name}")
    came = time.monotonic()
    listeners = {robot.name: robot.hear("chat/*") for robot in robots}
    speakers = [robot.say(f"chat/{robot.name}", size=100, rate=20) for robot in robots]
    for name, listener in listeners.items():
        for robot in robots:
            key = f"chat/{robot.name}"
            wait_until(lambda listener=listener, key=key: listener.numbers(key), 30, f"{key} heard by {name}")
    print(f"all hear all after {time.monotonic() - came:.1f} s")
    assert all(speaker.stop() for speaker in speakers)
    for listener in listeners.values():
        for robot in robots:
            numbers = listener.numbers(f"chat/{robot.name}")
            assert numbers == sorted(set(numbers))
    assert "what is no robot sends" not in str([robot.status()["warnings"] for robot in robots])


def test_a_firewall_that_lets_nothing_out_to_the_group_is_named(team):
    """The session is opened anew once, when that is over, and the samples are heard."""
    mute, other = team("ab", options=BROADCAST)
    drop = "table ip muted { chain out { type filter hook output priority 0; udp dport 7449 drop; }; };"
    assert mute.host.run("nft", drop).returncode == 0
    complaint = "nothing is sent to mesh.group 224.0.0.226:7449, nor heard: Operation not permitted"
    wait_until(lambda: mute.status()["warnings"] == [complaint], what="the warning")
    assert mute.status()["daemon"]["broadcast"]["reopened"] == 0
    mute.host.run("nft", "delete", "table", "ip", "muted")
    heard = other.hear("chat/*")
    mute.say(f"chat/{mute.name}", size=100, rate=20)
    wait_until(lambda: heard.numbers(f"chat/{mute.name}"), what="a sample")
    assert not mute.status()["warnings"]


def test_a_robot_that_hears_no_other_one_says_so(team):
    """As behind an access point that filters multicast; all else crosses, and nobody would know why no sample does."""
    deaf, _ = team("ab", options=BROADCAST)
    drop = "table ip deaf { chain in { type filter hook input priority 0; udp dport 7449 drop; }; };"
    assert deaf.host.run("nft", drop).returncode == 0
    complaint = "no robot is heard on mesh.group 224.0.0.226:7449, of 1 that broadcast there: "
    wait_until(lambda: [w for w in deaf.status()["warnings"] if w.startswith(complaint)], 30.0, "the warning")
    deaf.host.run("nft", "delete", "table", "ip", "deaf")
    wait_until(lambda: not deaf.status()["warnings"], 30.0, "its end")


def test_robots_on_different_transports_say_so_loudly(start):
    """Both name the other and what does not arrive; what goes by unicast does."""
    broadcasting, other = start("a", options=BROADCAST), start("b")
    for robot, name in ((broadcasting, "b"), (other, "a")):
        wait_until(robot.serves, what=f"start of {robot.name}")
        wait_until(lambda robot=robot, name=name: f"robot {name} has mesh.transport" in robot.log(), what="the warning")
        (warning,) = robot.status()["warnings"]
        assert "what one of them broadcasts does not reach the other" in warning
    heard = broadcasting.hear("from/b")
    other.say("from/b", size=100, rate=20)
    wait_until(lambda: heard.numbers("from/b"), what="a sample by unicast")


def sent(robots):
    """What all of them put on the air so far [B]."""
    return sum(robot.host.sent() for robot in robots)
