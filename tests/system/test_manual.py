"""What the guide to a Raspberry Pi tells root to type, on a host with a booted systemd."""

from contextlib import closing

import pytest

from tests.docs.pages import blocks
from tests.docs.test_guides import RASPBERRY_PI
from tests.system.booted import ROOT, Booted
from tests.waiting import wait_until

pytestmark = pytest.mark.system

INSTALLING = ("sudo apt install", "sudo python3 -m venv", "sudo /opt/sendworthy/bin/pip install")
"""What other tests do: the daemon is there already."""
SUDO = 'sudo() { "$@"; }; set -e; cd /run/shared\n'


@pytest.fixture
def booted(network, tmp_path):
    """A host without the service, where the repository's folder `deploy` is at hand."""
    host = Booted(network.add("a"), tmp_path / "booted", {}, started=False)
    with closing(host):
        (host.shared / "deploy").symlink_to(ROOT / "deploy")
        yield host


def typed(booted, lines):
    """Type lines as root does."""
    done = booted.run("bash", "-c", SUDO + "PATH=/opt/sendworthy/bin:$PATH\n" + "\n".join(lines))
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_a_robot_is_set_up_by_hand(booted):
    """From the files to a service that enforces."""
    _, by_hand, configured, _, profile = blocks(RASPBERRY_PI, "sh")
    lines = [line for line in by_hand.splitlines() if not line.startswith(INSTALLING)]
    assert len(lines) == 6
    typed(booted, lines)
    wait_until(lambda: booted.property("ActiveState") == "active", what="the service")
    checked, restarted, *asked = configured.splitlines()
    typed(booted, [*profile.splitlines(), checked, restarted])
    wait_until(lambda: booted.sendworthy("status").returncode == 0, what="an answer")
    assert "raspberry-pi.toml" in booted.sendworthy("config").stdout
    looked, *rest = asked
    assert looked == "sendworthy doctor"
    assert "configuration" in booted.run("/opt/sendworthy/bin/sendworthy", "doctor").stdout
    assert typed(booted, rest).endswith(": enforce\n")
