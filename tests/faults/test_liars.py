"""A robot that lies about itself: it takes room from the others while it does, and nothing else."""

import pytest

from tests.faults.scene import Numbers, Speaker
from tests.faults.strangers import Busy, Puppet
from tests.waiting import wait_until

pytestmark = pytest.mark.full


class Lies(Busy):
    """Says that it sends ten times what the limit has room for, and sends nothing."""

    pause = 0.05

    def __init__(self, puppet):
        super().__init__()
        self._puppet = puppet

    def act(self, number):
        if number % 20 == 0:
            self._puppet.tell_state("camera/liar")
        self._puppet.tell(messages=number + 1, size=25_000)


def test_who_claims_the_channel_gets_it_as_long_as_it_says_so(play, stack):
    """Others drop, with the reason; what bypasses goes, local samples are complete; then all is as before."""
    scene = play(limit="400 kbit/s", size=500, options=("--bridge.out.bypass", '["urgent"]'))
    urgent = Numbers(scene.application(scene.others[0]), "urgent")
    wait_until(lambda: "urgent" in scene.first.status()["daemon"]["observed"], what="demand")
    speaker = Speaker(scene.application(scene.first), "urgent", size=100, rate=20)
    stack.callback(speaker.stop)
    puppet = Puppet("liar", *(robot.mesh for robot in scene.robots.values()))
    stack.callback(puppet.close)
    wait_until(lambda: "liar" in scene.first.peers(), what="the liar")
    before = scene.first.status()["counts"]["dropped"]
    with Lies(puppet):
        wait_until(lambda: scene.first.status()["counts"]["dropped"] > before + 20, what="room that it takes")
        first = now = speaker.said
        wait_until(lambda: urgent.last > now, what="what bypasses")
    puppet.close()
    scene.meet()
    scene.go_on(10.0)
    speaker.stop()
    wait_until(lambda: urgent.last == speaker.said - 1, what="the last of what bypasses")
    assert len(urgent.heard) >= speaker.said - first, "what bypasses was held up"
    scene.finish(most=scene.speaker.said + speaker.said)
