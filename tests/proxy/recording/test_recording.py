"""Whether a daemon records, on real sessions."""

import gc
import json
import sys

import pytest

from proxy.bridge import keys
from proxy.config import AppConfig, Config, MeshConfig, RecordConfig, SpecsConfig
from proxy.daemon import Daemon
from proxy.recording.entries import Happened, Payload
from proxy.recording.errors import RecordingError
from proxy.recording.tuning import TUNING
from proxy.reloading import read_specs
from tests.daemons import specs_file
from tests.proxy.nodes import Heard, closing, free_endpoint, plain_session
from tests.proxy.recording.lives import entries
from tests.waiting import wait_until


class Robot:
    """A daemon and an application of its own; `told` asks it to record or not."""

    def __init__(self, stack, folder, **record):
        self.folder = folder / "recordings"
        app, self.mesh = free_endpoint(), free_endpoint()
        file = specs_file(folder)
        config = Config(
            robot="r1",
            app=AppConfig(listen=(app,)),
            mesh=MeshConfig(listen=(self.mesh,), scouting=False),
            specs=SpecsConfig(path=file),
            record=RecordConfig(folder=self.folder, **record),
        )
        self.daemon = Daemon(config, read_specs(file))
        self.daemon.start()
        stack.callback(self.daemon.stop)
        self.app = closing(stack, plain_session("client", connect=(app,)))
        self.heard = Heard(closing(stack, plain_session("peer", connect=(self.mesh,))), "robot/**")

    def told(self, order=None):
        payload = order if order is None or isinstance(order, bytes) else json.dumps(order)
        (reply,) = self.app.get(keys.record("r1"), payload=payload, timeout=60.0)
        return json.loads(reply.ok.payload.to_string()) if reply.ok else reply.err.payload.to_string()

    def status(self):
        (reply,) = self.app.get(keys.status("r1"), timeout=60.0)
        return json.loads(reply.ok.payload.to_string())

    def publish(self, data=b"x"):
        """Publish until a sample has crossed."""
        events = self.events()

        def crossed():
            self.app.put("robot/r1/camera", data)
            return self.events() > events

        wait_until(crossed, what="an event")

    def events(self):
        return self.daemon._loop.core.counts.by_reason.total()


@pytest.fixture
def robot(stack, tmp_path):
    return Robot(stack, tmp_path)


def test_a_daemon_records_when_it_is_told(robot):
    """Its status says so, until it is told to stop; then all is in the file."""
    assert robot.told() == {"on": False}
    assert "record" not in robot.status()["daemon"]
    begun = robot.told({"record": "start", "payloads": True})
    assert (begun["on"], begun["problem"]) == (True, "")
    robot.publish(b"payload")
    assert robot.status()["daemon"]["record"]["on"]
    ended = robot.told({"record": "stop"})
    assert (ended["on"], ended["file"], ended["missing"]) == (False, begun["file"], 0)
    found, problems = entries(robot.folder / begun["file"])
    assert not problems
    assert sum(isinstance(entry, Happened) for entry in found) == ended["events"]
    assert (found[0].robot, found[0].whole, found[0].payloads) == ("r1", False, True)
    assert any(isinstance(entry, Payload) and entry.data == b"payload" for entry in found)


def test_what_waits_to_be_written_is_not_looked_through_for_garbage(robot):
    """While it records; then as before."""
    before = gc.get_threshold()
    robot.told({"record": "start"})
    assert gc.get_threshold()[0] == TUNING.young > 2 * TUNING.many
    robot.told({"record": "stop"})
    assert gc.get_threshold() == before


def test_it_records_as_often_as_it_is_told(robot):
    """Each time anew, and once at a time."""
    one = robot.told({"record": "start"})
    assert robot.told({"record": "start"}) == f"it records already, to {one['file']}"
    robot.told({"record": "stop"})
    assert robot.told({"record": "stop"}) == "it does not record"
    assert robot.told({"record": "start"})["file"] != one["file"]


@pytest.mark.parametrize("order", [{"record": "later"}, {"record": "start", "payloads": 3}, [], 5, b"[" * 10_000])
def test_other_orders_are_refused(robot, order):
    """With what would do."""
    assert robot.told(order).startswith('recording is ordered with {"record": "start"')


def test_a_daemon_may_record_from_its_start_on(stack, tmp_path):
    """The core begins with the first event, and the file is closed with the daemon."""
    robot = Robot(stack, tmp_path, on=True)
    robot.publish()
    robot.daemon.stop()
    (file,) = robot.folder.iterdir()
    found, problems = entries(file)
    assert not problems
    assert (found[0].whole, found[0].number, found[0].now) == (True, 0, robot.daemon._loop.core.started)
    assert found[0].settings == robot.daemon._loop.core.settings


def test_where_nothing_can_be_recorded_the_daemon_goes_on(stack, tmp_path):
    """And warns."""
    (tmp_path / "recordings").write_text("a file stands in the way")
    robot = Robot(stack, tmp_path, on=True)
    robot.publish()
    assert any(
        f"nothing is recorded: {tmp_path}/recordings: File exists" in each for each in robot.status()["warnings"]
    )


def test_without_the_extra_it_says_which_to_install(robot, monkeypatch):
    """The library is loaded when it is needed."""
    for name in ("proxy.recording.output", "proxy.recording.recorder"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.setitem(sys.modules, "proxy.recording.output", None)
    assert robot.told({"record": "start"}) == 'recording needs the extra "record": pip install "sendworthy[record]"'
    with pytest.raises(RecordingError, match="needs the extra"):
        robot.daemon.recording.start(payloads=False)


def test_what_is_missing_is_a_warning(robot):
    """As long as it records."""
    robot.told({"record": "start"})
    recording = robot.daemon.recording
    output = recording._recorder._output
    output.written = output.written.lacking(3)
    assert recording.warnings() == ["3 events are missing in the recording"]
    robot.told({"record": "stop"})
    assert recording.warnings() == []
