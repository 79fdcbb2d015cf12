"""The package for arm64, as on a Raspberry Pi: this machine emulates one.

It takes two minutes, so `make qualify STAGES=arm64` runs it.
"""

import platform
import shutil
import subprocess
import sys

import pytest

from tests.system.debian import PYTHON, RELEASE, ROOT, emulated, packed
from tests.system.robots import SENDWORTHY, Robot
from tests.waiting import wait_until

pytestmark = [
    pytest.mark.system,
    pytest.mark.skipif(sys.version_info[:2] != PYTHON, reason=f"packages for {RELEASE} are made with its Python"),
    pytest.mark.skipif(platform.machine() != "x86_64", reason="compares x86_64 with arm64"),
]

OWN = "/opt/sendworthy/bin/python3"
CLIENT = "/usr/share/sendworthy/apps/client.json5"
AGREEMENT = "tests/planner/agreement.py"
KEYS = {"a": "robot/a/camera", "b": "robot/b/camera"}
LIMIT = "200 kbit/s"
RECORDING = ("--record.on", "true")


@pytest.fixture(scope="module")
def debian(tmp_path_factory):
    """A Debian for arm64 with the package."""
    return emulated(packed("arm64"), tmp_path_factory.mktemp("arm64") / "root")


class Emulated(Robot):
    """A robot whose daemon and applications are those of the package; who asks it is not."""

    def __init__(self, host, folder, debian):
        self.inside = host.inside(debian, OWN)
        super().__init__(host, folder, limit=LIMIT, interface="wlan0", options=RECORDING)

    def start(self):
        """Start the daemon."""
        command = ("/usr/bin/sendworthy", "run", "--config", str(self._folder / "sendworthy.toml"), *self._options)
        with self._log.open("w") as log:
            self.daemon = self.inside.start(*command, stderr=log)


def test_both_engines_plan_there_as_here(debian):
    """Node by node on either machine, and to the last bit on both."""
    subprocess.run(["cp", "-r", ROOT / "tests", debian / "srv"], check=True)
    there = subprocess.check_output(["chroot", debian, OWN, f"/srv/{AGREEMENT}"])
    here = subprocess.check_output([sys.executable, ROOT / AGREEMENT])
    assert len(here.splitlines()) > 100
    assert there.splitlines() == here.splitlines()


def test_a_robot_of_each_kind_decide_alike(debian, network, start, tmp_path):
    """Contended samples of plain applications cross both ways, and what one decided the other would have, too.

    The emulator knows no multicast groups: the robots are told where they are, as are the applications.
    """
    (tmp_path / "b").mkdir()
    b = Emulated(network.add("b"), tmp_path / "b", debian)
    a = start("a", limit=LIMIT, options=RECORDING, mesh=f'connect = ["tcp/{b.host.address}:7500"]')
    try:
        wait_until(a.serves, what="start of a")
        wait_until(b.serves, what="start of b")
        wait_until(lambda: (a.peers(), b.peers()) == ({"b"}, {"a"}), what="each to know the other")
        where = {a: {}, b: {"host": b.inside, "setting": CLIENT}}
        listeners = {robot: robot.hear("robot/*/camera", **options) for robot, options in where.items()}
        for robot, options in where.items():
            robot.wait_wanted(KEYS[robot.name])
            robot.say(KEYS[robot.name], size=4000, rate=10, **options)
        wait_until(lambda: len(listeners[a].numbers(KEYS["b"])) >= 30, what="samples of b")
        wait_until(lambda: len(listeners[b].numbers(KEYS["a"])) >= 30, what="samples of a")
        for robot in (a, b):
            found = robot.status()
            assert found["decisions"]["made"] > 0
            assert found["counts"]["dropped"] > 0
        assert {peer["version"] for robot in (a, b) for peer in robot.status()["peers"]} == {a.status()["version"]}
        assert a.stop() == 0
        assert b.stop() == 0
    finally:
        b.close()
    kept = {robot: next((tmp_path / robot.name / "recordings").glob("*.mcap")) for robot in (a, b)}
    shutil.copy(kept[a], debian / "srv")
    replay(*SENDWORTHY, "replay", kept[b])
    replay("chroot", debian, "sendworthy", "replay", f"/srv/{kept[a].name}")


def replay(*command):
    """Have a recording gone through once more, which finds each decision equal."""
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "decisions and" in done.stdout
    assert done.stdout.endswith("all equal\n")
