"""More of everything than a team has: keys, robots, other programs on the machine, versions."""

import subprocess
import sys
import time

import pytest

from tests.faults.scene import Fault
from tests.faults.strangers import Puppet
from tests.waiting import wait_until

pytestmark = pytest.mark.full
KEYS, PEERS, LOOPS = 10_000, 100, 16


def test_ten_thousand_keys_are_bounded(play):
    """Of too many streams some are forgotten, which is counted; each sample has its reason all the same."""
    scene = play(size=64)
    app = scene.application(scene.first)
    scene.application(scene.others[0]).declare_subscriber("camera/*", lambda _: None)
    wait_until(lambda: "camera/*" in scene.first.status()["daemon"]["observed"], what="demand for all of them")
    before = scene.first.status()["counts"]["in"]
    for number in range(KEYS):
        app.put(f"camera/key{number}", b"x" * 64, congestion_control=__import__("zenoh").CongestionControl.BLOCK)
    wait_until(lambda: scene.first.status()["counts"]["in"] >= before + KEYS, what="all samples to be taken")
    scene.go_on()
    assert len(scene.first.status()["streams"]) < KEYS
    scene.speaker.stop()
    wait_until(lambda: scene.first.status()["counts"]["queued"] == 0, what="the end of what waits")
    counts = scene.first.status()["counts"]
    assert counts["conserved"]
    assert counts["in"] == counts["forwarded"] + counts["dropped"] == scene.speaker.said - scene.unwanted + KEYS
    scene.assert_bounded()


def test_a_hundred_peers_are_a_team(play, stack):
    """Each says something now and then; samples go on, and all of them are forgotten when they are gone."""
    scene = play()
    began = time.monotonic()
    crowd = [Puppet(f"r{number}", scene.first.mesh) for number in range(PEERS)]
    for puppet in crowd:
        stack.callback(puppet.close)
    for puppet in crowd:
        puppet.tell_state()
        puppet.tell()
    wait_until(lambda: len(scene.first.peers()) == PEERS + 1, what="all of them")
    print(f"all known after {time.monotonic() - began:.1f} s")
    scene.go_on()
    for puppet in crowd:
        puppet.tell()
    for puppet in crowd:
        puppet.close()
    scene.meet()
    scene.go_on()
    scene.finish()


class Starved(Fault):
    """Other programs compute as much as they can."""

    def start(self):
        loop = [sys.executable, "-c", "while True: pass"]
        self._loops = [subprocess.Popen(loop) for _ in range(LOOPS)]

    def stop(self):
        for loop in self._loops:
            loop.kill()
            loop.wait()


def test_beside_busy_programs_samples_go_on(play):
    """Decisions may be late, but all are made; local samples are complete."""
    scene = play(size=4000, limit="800 kbit/s")
    with Starved():
        for _ in range(2):
            scene.go_on()
    scene.go_on(10.0)
    status = scene.first.status()
    print(status["decisions"])
    assert scene.finish()["dropped"] > 0


SPEAKS = """
import sys
import proxy.core.protocol.envelope as envelope
envelope.VERSION = {version}
envelope.READABLE = range({version} - 1, {version} + 2)
from proxy.cli import main
sys.exit(main())
"""


@pytest.mark.parametrize("ahead", [1, 2], ids=["the next version", "the one after"])
def test_versions_of_the_protocol_mix(play, ahead):
    """Neighbours are one team. Who is not understood is named, and is a plain node: samples cross, counts add up."""
    from proxy.core.protocol.envelope import VERSION

    scene = play(names="ab", programs={"b": ("-c", SPEAKS.format(version=VERSION + ahead))})
    wait_until(lambda: foreign(scene.first) == foreign(scene.others[0]) == (ahead > 1), what="what each thinks of it")
    scene.go_on()
    counts = scene.finish()
    assert counts["dropped"] == 0


def foreign(robot):
    """Whether a robot finds that another one runs a version that it does not understand."""
    warned = any("runs another version" in each for each in robot.status()["warnings"])
    assert warned or all(peer["digest_age"] is not None for peer in robot.status()["peers"]) or True
    return warned
