"""The service under a booted systemd, with all that its unit takes from it: what is left is enough."""

import json
import re
import signal
import subprocess
from contextlib import ExitStack, closing

import pytest

from tests.system.booted import ROOT, SHIPPED, Booted
from tests.system.network import RADIO
from tests.system.robots import Listener, Speaker
from tests.waiting import wait_until

pytestmark = pytest.mark.system

SURVEILLANCE = ROOT / "utility_specs" / "surveillance.toml"
KEY = "robot/a/camera"
SPECS_FOLDER = "/var/lib/sendworthy/specs.d"
CONFIG = f"""
robot = "a"
[mesh]
interface = "{RADIO}"
[specs]
path = "{SPECS_FOLDER}"
[fleet]
specs = true
[record]
on = true
"""
EXPOSURE = 15
"""What systemd may find exposed at most, in tenths, of a hundred."""


@pytest.fixture
def booted(network, tmp_path):
    """A host with the service, whose folder of specs is still to come."""
    place = tmp_path / "booted"
    with closing(Booted(network.add("a"), place, {"/etc/sendworthy/sendworthy.toml": CONFIG})) as host:
        wait_until(lambda: host.property("ActiveState") == "active", what="the service")
        yield host


@pytest.fixture
def heard(booted, network, start, tmp_path):
    """Contended samples cross from an application beside the service to one of another robot: what that hears."""
    (booted.shared / "pushed.toml").write_text(SURVEILLANCE.read_text().replace("2 Mbit/s", "200 kbit/s"))
    pushed = booted.sendworthy("push", "/run/shared/pushed.toml")
    assert pushed.returncode == 0, pushed.stderr
    other = start("b", limit="200 kbit/s")
    wait_until(other.serves, what="start of b")
    with ExitStack() as closing_all:
        listener = Listener(network.hosts["b"], tmp_path / "heard", "hear", KEY)
        closing_all.callback(listener.close)
        wait_until(listener.ready, what="an application of b")
        speaker = Speaker(network.hosts["a"], tmp_path / "spoken", "say", KEY, "4000", "20")
        closing_all.callback(speaker.close)
        wait_until(speaker.ready, what="an application of a")
        yield lambda: listener.numbers(KEY)


def status(booted):
    """What the service says of itself."""
    return json.loads(booted.sendworthy("status", "--json").stdout)


def test_systemd_finds_little_exposed():
    """As it counts what a unit may do, and as the manual says."""
    command = ("systemd-analyze", "security", "--offline=true", f"--threshold={EXPOSURE}", "--no-pager", str(SHIPPED))
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-200:]
    level = re.search(r"Overall exposure level.*: (\d\.\d)", done.stdout)[1]
    assert f"says {level} of 10" in (ROOT / "docs/guides/raspberry-pi.md").read_text()


def test_the_service_does_all_it_does_elsewhere(booted, heard):
    """It takes specs, looks into samples, decides, records, and shows where its time goes."""
    wait_until(lambda: len(heard()) >= 20, what="samples")
    found = status(booted)
    assert found["counts"]["dropped"] > 0
    assert found["decisions"]["made"] > 0
    assert booted.run("ls", SPECS_FOLDER).stdout.split() == ["pushed.toml"]
    profile = booted.sendworthy("profile", "--json")
    assert profile.returncode == 0, profile.stderr
    assert found["warnings"] == []
    assert booted.run("ls", "/var/lib/sendworthy/recordings").stdout.endswith(".mcap\n")


def test_nothing_else_is_allowed(booted):
    """No capability, no system call beyond those of services, no file but its own."""
    process = booted.property("MainPID")
    of = dict(line.split(":\t", 1) for line in booted.run("cat", f"/proc/{process}/status").stdout.splitlines())
    assert (of["CapBnd"], of["CapEff"]) == ("0" * 16, "0" * 16)
    assert (of["NoNewPrivs"], of["Seccomp"]) == ("1", "2")
    beside = ("nsenter", "--target", process, "--mount", "--")
    assert "Read-only" in booted.run(*beside, "touch", "/etc/hosts").stderr
    assert booted.run(*beside, "ls", "/root", "/home").stdout.split() == ["/home:", "/root:"]


def test_the_service_reloads_what_is_right_and_comes_back_when_killed(booted, heard):
    """What is wrong is refused and said; samples cross again after the end of the process."""
    wait_until(lambda: len(heard()) >= 5, what="samples")
    process = booted.property("MainPID")
    specs = f"{SPECS_FOLDER}/pushed.toml"
    before = status(booted)["specs"]
    booted.run("sed", "-i", "s/weight = 1.0/weight = 2.0/", specs)
    assert booted.run("systemctl", "reload", "sendworthy").returncode == 0
    wait_until(lambda: status(booted)["specs"] != before, what="other specs")
    booted.run("sed", "-i", "s/weight = 2.0/weight = heavy/", specs)
    assert booted.run("systemctl", "reload", "sendworthy").returncode != 0
    wait_until(lambda: f"{specs}:" in booted.said(), what="what is wrong")
    assert booted.property("MainPID") == process
    booted.run("sed", "-i", "s/weight = heavy/weight = 2.0/", specs)
    booted.run("kill", f"-{signal.SIGKILL}", process)
    wait_until(lambda: booted.property("MainPID") not in (process, "0"), what="another process")
    count = len(heard())
    wait_until(lambda: len(heard()) >= count + 5, what="samples after the end of the process")
    assert booted.run("systemctl", "stop", "sendworthy").returncode == 0
    assert booted.property("Result") == "success"
