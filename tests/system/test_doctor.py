"""`sendworthy doctor` on hosts of their own, whose interface is down, does no multicast, or has a firewall."""

import json
import subprocess

import pytest

from tests.system.network import RADIO, ROOT, ip
from tests.system.robots import SENDWORTHY
from tests.waiting import wait_until

pytestmark = pytest.mark.system

ORDINARY = ("setpriv", "--bounding-set", "-dac_override,-dac_read_search")
"""Starts a program that may read no more than the modes of files say, as everybody but root."""
SCOUTING, SAMPLES = "224.0.0.225:7448", "224.0.0.226:7449"


@pytest.fixture
def host(network):
    """A host without a daemon."""
    return network.add("a")


def look(host, *flags):
    """Return state and text by check, of interface and multicast, in the order told."""
    done = host.run(*SENDWORTHY, "doctor", "--json", "--mesh.interface", RADIO, *flags)
    assert done.stderr == ""
    return [
        (each["state"], each["text"]) for each in json.loads(done.stdout) if each["check"] in {"interface", "multicast"}
    ]


def test_a_radio_that_is_up_and_does_multicast_is_fine(host):
    """In both families."""
    fine = [("fine", f"{RADIO}: up"), ("fine", f"{RADIO}: a message to {SCOUTING} is heard")]
    assert look(host) == fine
    broadcast = ("--mesh.transport", "broadcast")
    assert look(host, *broadcast) == [*fine, ("fine", f"{RADIO}: a message to {SAMPLES} is heard")]
    group = "[ff02::226]:7449"
    local = f"{RADIO} has only link-local addresses of IPv6, and Zenoh cannot use them: "
    lacking = ("finding", f"{local}give it another one, or take a mesh.group of IPv4")
    wait_until(lambda: lacking in look(host, *broadcast, "--mesh.group", group), what="an address of IPv6")
    ip("-n", host.namespace, "address", "add", "fd00::1/64", "dev", RADIO)
    heard = ("fine", f"{RADIO}: a message to {group} is heard")
    wait_until(lambda: heard in look(host, *broadcast, "--mesh.group", group), what="another address of IPv6")


def test_what_keeps_robots_from_being_found_is_said(host):
    """With the command that mends it; each is mended by that command."""
    ip("-n", host.namespace, "link", "set", "dev", RADIO, "multicast", "off")
    ((_, up), (state, text)) = look(host)
    assert (up, state) == (f"{RADIO}: up", "finding")
    assert f"{RADIO} does no multicast: sudo ip link set dev {RADIO} multicast on" in text
    ip("-n", host.namespace, "link", "set", "dev", RADIO, "multicast", "on")
    rules = "table ip filter { chain input { type filter hook input priority 0; udp dport 7448 drop; }; };"
    assert host.run("nft", rules).returncode == 0
    state, text = look(host)[1]
    assert state == "finding"
    assert text.startswith(f"{RADIO}: a message to {SCOUTING} is lost: let it through the firewall, or set mesh.scou")
    assert len(look(host, "--mesh.scouting", "false")) == 1
    host.run("nft", "delete", "table", "ip", "filter")
    host.radio("down")
    assert look(host) == [("finding", f"{RADIO} is down: sudo ip link set dev {RADIO} up")]
    host.radio("up")
    host.port("down")
    wait_until(lambda: "has no carrier" in look(host)[0][1], what="the carrier to go")
    host.port("up")
    wait_until(lambda: look(host)[0][0] == "fine", what="the carrier to come")
    ip("-n", host.namespace, "address", "flush", "dev", RADIO)
    assert f"{RADIO} has no IPv4 address" in look(host)[0][1]


BUSY = """
import socket, time
sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
while True:
    sender.sendto(b"sample", ("224.0.0.226", 7449))
    time.sleep(0.05)
"""


def test_a_message_that_is_lost_is_found_beside_others_that_are_heard(host, network):
    """What others say on the group is no answer, and holds nobody up."""
    other = network.add("b")
    ip("-n", other.namespace, "route", "add", "224.0.0.0/4", "dev", RADIO)
    own = f"ip saddr {host.address} udp dport 7449 drop"
    rules = f"table ip filter {{ chain input {{ type filter hook input priority 0; {own}; }}; }};"
    assert host.run("nft", rules).returncode == 0
    sending = other.start(other.python, "-c", BUSY)
    try:
        *_, (state, text) = look(host, "--mesh.transport", "broadcast")
    finally:
        sending.kill()
        sending.wait()
    assert state == "finding"
    assert f"a message to {SAMPLES} is lost" in text


def test_broadcast_goes_on(start):
    """What is tried beside a daemon goes nowhere where it hears samples, and it complains of nothing."""
    robot = start("a", options=("--mesh.transport", "broadcast"))
    wait_until(robot.serves, what="the start")
    before = robot.status()
    found = look(robot.host, "--mesh.transport", "broadcast", "--robot", "a")
    assert ("fine", f"{RADIO}: a message to {SCOUTING} is heard") in found
    after = robot.status()
    assert (after["malformed"], after["warnings"]) == (before["malformed"], before["warnings"])
    assert robot.log().count("\n") == 1, "nothing but that it has started"


def test_what_only_others_may_see_could_not_be_looked_at(tmp_path):
    """That is no finding: an operator without sudo is told to take it."""
    config, own = tmp_path / "sendworthy.toml", tmp_path / "own"
    config.write_text(f'[specs]\npath = "{own}/specs.d"\n[record]\non = true\nfolder = "{own}/recordings"\n')
    own.mkdir(mode=0o000)

    def barred():
        words = ("doctor", "--json", "--config", str(config), "--connect", "tcp/127.0.0.1:1")
        done = subprocess.run([*ORDINARY, *SENDWORTHY, *words], cwd=ROOT, capture_output=True, text=True, check=False)
        assert done.stderr == ""
        return {each["check"]: each["text"] for each in json.loads(done.stdout) if each["state"] == "unknown"}

    found = barred()
    assert found["specs"] == f"{own}/specs.d: cannot be read: Permission denied: run it with sudo"
    assert found["recordings"] == f"{own}/recordings: Permission denied: run it with sudo"
    (tmp_path / "conf.d").mkdir(mode=0o000)
    assert barred()["configuration"] == f"{tmp_path}/conf.d: cannot be read: Permission denied: run it with sudo"
    (tmp_path / "conf.d").rmdir()
    config.chmod(0o000)
    assert barred()["configuration"] == f"{config}: cannot be read: Permission denied: run it with sudo"
