"""Unmodified applications on two robots, each kept at its daemon by one of the drop-ins: nothing goes around."""

import shlex
import subprocess
from contextlib import ExitStack

import pytest

from tests.deploy.test_apps import APPS, variables
from tests.waiting import wait_until

pytestmark = pytest.mark.system

KEY = "chat/a"
RATE = 20
MESH = 7500
"""The port of the daemons."""


@pytest.fixture
def two(start):
    """Two robots that know each other."""

    def start_two(app=""):
        robots = [start(name, app=app) for name in ("a", "b")]
        for robot in robots:
            wait_until(robot.serves, what=f"start of {robot.name}")
        for robot in robots:
            wait_until(robot.peers, what="the other")
        return robots

    return start_two


def only_through_the_daemons(robots, *options):
    """What an application says arrives once and in order; nothing arrives while the daemon beside it is away."""
    speaking, listening = robots
    listener = listening.hear(KEY, **options[-1])
    speaker = speaking.say(KEY, size=20, rate=RATE, **options[0])
    wait_until(lambda: len(listener.numbers(KEY)) >= RATE, 30, "samples")
    for robot in robots:
        ports = robot.host.links()
        assert ports
        assert all(MESH in pair for pair in ports), "a link goes around the daemons"
    speaking.kill()
    last = listener.numbers(KEY)[-1]
    speaking.start()
    wait_until(lambda: len(listener.numbers(KEY)) > 2 * last, 30, "samples after the restart")
    total = speaker.stop()
    wait_until(lambda: listener.numbers(KEY)[-1] == total - 1, what="the last sample")
    heard = listener.numbers(KEY)
    assert heard == sorted(set(heard))
    missing = sorted(set(range(heard[0], total)) - set(heard))
    print(f"daemon restarted: {len(missing) / RATE:.2f} s missing")
    assert missing
    assert missing == list(range(missing[0], missing[-1] + 1))


def warnings_of_none(robots):
    """What is prevented is no warning, even while the applications still run."""
    for robot in robots:
        wait_until(robot.looked, 30, "a look around")
        assert robot.status()["warnings"] == []


def test_without_a_drop_in_applications_go_around_the_daemon(two):
    """In Zenoh's default configuration they find each other over the radio, with no daemon at all."""
    one, other = two()
    for robot in (one, other):
        robot.kill()
    listener = other.hear(KEY, setting="default")
    one.say(KEY, size=20, rate=RATE, setting="default")
    wait_until(lambda: len(listener.numbers(KEY)) >= RATE, what="samples around the daemons")
    assert not any(MESH in pair for pair in one.host.links())


@pytest.mark.parametrize("app", ["", "scouting = true"])
def test_the_daemon_warns_of_an_application_that_others_find(two, app):
    """Whether the daemon answers scouts or not, an application with Zenoh's defaults is said, while it is."""
    one, other = two(app)
    listener = one.hear(KEY, setting="default")
    wait_until(lambda: "deploy/apps" in " ".join(one.status()["warnings"]), 30, "the warning")
    assert f"at tcp/{one.host.address}:" in one.status()["warnings"][0]
    assert other.status()["warnings"] == []
    listener.close()
    wait_until(lambda: not one.status()["warnings"], 30, "the end of the warning")


@pytest.mark.parametrize("file", ["client.json5", "peer.json5"])
def test_a_configuration_file_keeps_applications_at_their_daemon(two, file):
    """For those that read a file."""
    only_through_the_daemons(two(), {"setting": str(APPS / file)})


def test_the_environment_keeps_applications_at_their_daemon(two):
    """For those that take their configuration from the environment."""
    environ = variables(APPS / "zenoh.env")
    assert environ["ZENOH_CONFIG"] == "/etc/sendworthy/apps/client.json5"
    environ["ZENOH_CONFIG"] = str(APPS / "client.json5")
    only_through_the_daemons(two(), {"setting": "environment", **environ})


def test_rules_of_the_firewall_keep_default_applications_at_their_daemon(two):
    """With the nftables rules, and a daemon that answers scouts, for Zenoh's default configuration."""
    robots = two("scouting = true")
    for robot in robots:
        loaded = robot.host.run("nft", "-f", str(APPS / "radio.nft"))
        assert loaded.returncode == 0, loaded.stderr
    only_through_the_daemons(robots, {"setting": "default"})
    warnings_of_none(robots)


def test_a_namespace_keeps_default_applications_at_their_daemon(network, start):
    """In the namespace of the systemd unit, beside a daemon that listens on its end, for the same."""
    with ExitStack() as closing:
        app = 'listen = ["tcp/127.0.0.1:7447", "tcp/10.74.47.1:7447"]\nscouting = true'
        robots, hosts = [], []
        for name in ("a", "b"):
            host = network.add(name)
            hosts.append(inner(host, closing))
            robots.append(start(name, app=app, host=host))
        for robot in robots:
            wait_until(robot.serves, what=f"start of {robot.name}")
        for robot in robots:
            wait_until(robot.peers, what="the other")
        only_through_the_daemons(robots, *({"setting": "default", "host": host} for host in hosts))
        warnings_of_none(robots)


def commands(kind):
    """The commands of the unit: of `ExecStart` or `ExecStopPost`."""
    lines = (APPS / "sendworthy-apps.service").read_text().splitlines()
    return [line.partition("=")[2].removeprefix("-") for line in lines if line.startswith(f"{kind}=")]


def inner(host, closing):
    """Do on the host what the unit does; return its namespace for applications."""
    name = f"{host.namespace}-apps"

    def run(command):
        command = command.replace("sendworthy-apps", name)
        # Not `ip netns exec`, which hides the mounts that a new namespace is.
        subprocess.run(["nsenter", f"--net=/run/netns/{host.namespace}", *shlex.split(command)], check=True)

    for command in commands("ExecStart"):
        run(command)
    for command in commands("ExecStopPost"):
        closing.callback(run, command)
    return host.within(name)
