"""A daemon gets no more file descriptors."""

import json
import resource
from pathlib import Path

import pytest

from proxy.bridge import keys
from tests.faults.scene import Fault
from tests.proxy.nodes import answers
from tests.waiting import wait_until

pytestmark = pytest.mark.full


class NoDescriptors(Fault):
    """A daemon may open nothing more: neither files nor links."""

    def __init__(self, robot):
        self._pid = robot.pid

    def start(self):
        opened = len(list(Path(f"/proc/{self._pid}/fd").iterdir()))
        self._usual = resource.prlimit(self._pid, resource.RLIMIT_NOFILE)
        resource.prlimit(self._pid, resource.RLIMIT_NOFILE, (opened, self._usual[1]))

    def stop(self):
        resource.prlimit(self._pid, resource.RLIMIT_NOFILE, self._usual)


def test_without_descriptors_what_is_linked_goes_on(play):
    """Samples and decisions go on; specs that cannot be read leave those in force; later all is as before."""
    scene = play()
    in_force = scene.first.status()["specs"]
    operator = scene.application(scene.first)
    with NoDescriptors(scene.first):
        scene.specs.write_text(scene.specs.read_text().replace("4 Mbit/s", "3 Mbit/s"))
        scene.go_on()
        wait_until(lambda: answered(operator)["daemon"]["reloads"]["problems"], what="specs that cannot be read")
        assert answered(operator)["specs"] == in_force
    scene.specs.write_text(scene.specs.read_text().replace("3 Mbit/s", "2 Mbit/s"))
    wait_until(lambda: scene.first.status()["specs"] != in_force, 30.0, "new specs to be in force")
    scene.go_on()
    scene.finish()


def answered(operator):
    """The status, asked for over a link that is there: there is no other."""
    (answer,) = answers(operator, keys.status("a"))
    return json.loads(answer)
