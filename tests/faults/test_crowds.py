"""More of everything than a team has: keys, robots, other programs on the machine, versions."""

import os
import subprocess
import sys
import time

import pytest
import zenoh

from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.envelope import VERSION
from tests.faults.scene import Fault
from tests.faults.strangers import Puppet
from tests.waiting import wait_until

pytestmark = pytest.mark.full
KEYS = int(os.environ.get("KEYS", "500"))
"""That come at once. The long run has ten thousand, which take a core minutes: each is a decision of its own."""
CROWD = 128 << 20
"""What they may take: it is known of each whether it crosses, and of 4,096 at a time all that there is to plan [B]."""
PEERS, LOOPS = 100, 16
STREAMS = CoreSettings("a", "0a").streams


def test_a_flood_of_keys_is_bounded(play):
    """Local samples go on meanwhile; of too many streams some are forgotten; each sample has its reason."""
    scene = play(size=64)
    app = scene.application(scene.first)
    scene.application(scene.others[0]).declare_subscriber("camera/*", lambda _: None)
    wait_until(lambda: "camera/*" in scene.first.status()["daemon"]["observed"], what="demand for all of them")
    computed, (held, _) = scene.first.processor_time(), scene.first.memory()
    for number in range(KEYS):
        app.put(f"camera/key{number}", bytes(64), congestion_control=zenoh.CongestionControl.BLOCK)
    scene.go_on(listeners=[scene.local])
    scene.speaker.stop()
    began = time.monotonic()
    wait_until(lambda: taken(scene) >= KEYS, 60.0 + KEYS / 10, what="all samples to be taken")
    took, more = time.monotonic() - began, (scene.first.memory()[0] - held) >> 20
    each = (scene.first.processor_time() - computed) / KEYS
    print(
        f"{KEYS} keys at once: decided {took:.1f} s later, {1000 * each:.1f} ms of processor time each, {more} MB more"
    )
    assert len(scene.first.status()["streams"]) <= STREAMS
    scene.finish(most=scene.stop() + KEYS, growth=CROWD)


def taken(scene):
    """How many samples are decided, of the many keys and of the one that was there before."""
    counts = scene.first.status()["counts"]
    return counts["forwarded"] + counts["dropped"] if counts["queued"] == 0 else 0


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
    scene = play(names="ab", programs={"b": ("-c", SPEAKS.format(version=VERSION + ahead))})
    wait_until(lambda: foreign(scene.first) == foreign(scene.others[0]) == (ahead > 1), what="what each thinks of it")
    scene.go_on()
    scene.finish()


def foreign(robot):
    """Whether a robot says that another one runs a version that it does not understand; None: it knows of none yet."""
    status = robot.status()
    if any("runs another version" in each for each in status["warnings"]):
        return True
    return False if any(stream["robot"] != robot.name for stream in status["streams"]) or heard(status) else None


def heard(status):
    """Whether another robot has answered a digest of this one."""
    return any(peer["latency_out"] is not None for peer in status["peers"])
