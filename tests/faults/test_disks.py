"""A disk without room: recordings and specs stand on it."""

import subprocess
from contextlib import suppress

import pytest
from mcap.reader import make_reader

from proxy.cli import main
from tests.faults.scene import Fault, Scene
from tests.waiting import wait_until

pytestmark = pytest.mark.system
SIZE = 16 << 20
"""Of the disk [B]."""


class Full(Fault):
    """Something else takes all room on a disk."""

    def __init__(self, folder):
        self._file = folder / "full"

    def start(self):
        with suppress(OSError), self._file.open("wb", buffering=0) as file:
            while file.write(bytes(1 << 12)):
                pass

    def stop(self):
        self._file.unlink()


@pytest.fixture
def disk(tmp_path, stack):
    """A small disk of its own."""
    folder = tmp_path / "disk"
    folder.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={SIZE}", "tmpfs", str(folder)], check=True)
    stack.callback(subprocess.run, ["umount", "--lazy", str(folder)], check=True)
    return folder


def test_a_full_disk_stops_nothing(disk, tmp_path, stack, capsys):
    """Samples go on, pushed specs are refused whole and a recording tells what is missing; later all is as before."""
    options = ("--record.on", "true", "--record.folder", str(disk / "recordings"), "--fleet.specs", "true")
    scene = Scene(disk, stack, options=options)
    in_force, new = scene.first.status()["specs"], tmp_path / "new.toml"
    new.write_text(scene.specs.read_text().replace("4 Mbit/s", "3 Mbit/s"))
    push = ["push", str(new), "--connect", scene.first.app, "--robot", "a"]
    (path,) = (disk / "recordings").glob("a-*.mcap")
    wait_until(lambda: messages(path) > 2, 30.0, "events in the recording")
    with Full(disk):
        wait_until(lambda: missing(scene.first), 30.0, "what a recording lacks")
        assert main(push) == 1
        assert "No space left on device" in capsys.readouterr().err
        scene.go_on()
        assert scene.first.status()["specs"] == in_force
        assert messages(path) > 2, "other programs read what a full disk cut"
    wait_until(lambda: main(push) == 0, 30.0, "new specs to be in force")
    assert scene.first.status()["specs"] != in_force
    scene.go_on()
    scene.finish()


def messages(path):
    """How many messages of a recording other programs read, by its end."""
    with path.open("rb") as file:
        return sum(1 for _ in make_reader(file).iter_messages())


def missing(robot):
    """How much a robot says that its recording lacks."""
    return [warning for warning in robot.status()["warnings"] if "record" in warning]
