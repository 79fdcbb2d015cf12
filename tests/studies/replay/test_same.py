"""Exact replays of recordings of real daemons."""

import json
import os
import random
import re
import subprocess
import sys
import threading
from contextlib import ExitStack
from dataclasses import replace

import pytest

from planner import Plan
from proxy.bridge import keys
from proxy.config import AppConfig, Config, MeshConfig, RecordConfig, SpecsConfig
from proxy.core.interface import events as ev
from proxy.daemon import Daemon
from proxy.recording.entries import Gap, Happened, Snapshot, Start
from proxy.recording.errors import RecordingError
from proxy.recording.reading import RecordingReader
from proxy.recording.writing import RecordingWriter
from proxy.reloading import read_specs
from studies.replay.same import SameReplay, lives, replayed, stretches
from tests.proxy.nodes import Heard, closing, free_endpoint, plain_session
from tests.proxy.recording.lives import recorded
from tests.waiting import wait_until

SPECS = """
[[constraint]]
kind = "throughput"
limit = "LIMIT"
window = 0.5
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
weight = WEIGHT
utility = { kind = "video" }
[[information_type]]
name = "pose"
keys = ["robot/*/pose"]
aggregation = "sum"
utility = { kind = "step", lifetime = "1 s" }
"""
TIGHT = SPECS.replace("LIMIT", "200 kbit/s").replace("WEIGHT", "1.0")
TIGHTER = SPECS.replace("LIMIT", "120 kbit/s").replace("WEIGHT", "3.0")


class Robot:
    """A daemon that records, and an application that publishes and hears."""

    def __init__(self, stack, name, folder, connect=(), *, on=True, **record):
        self.name, self.app, self.mesh = name, free_endpoint(), free_endpoint()
        self.file = folder / f"{name}.toml"
        self.file.write_text(TIGHT)
        config = Config(
            robot=name,
            app=AppConfig(listen=(self.app,)),
            mesh=MeshConfig(listen=(self.mesh,), connect=connect, scouting=False),
            specs=SpecsConfig(path=self.file),
            record=RecordConfig(on=on, folder=folder / "recordings", payloads=on).model_copy(update=record),
        )
        self.daemon = Daemon(config, read_specs(self.file), self.file)
        self.daemon.start()
        stack.callback(self.daemon.stop)
        self.session = closing(stack, plain_session("client", connect=(self.app,)))
        self.heard = Heard(self.session, "robot/**")
        self.draw = random.Random(name)

    def publish(self):
        self.session.put(f"robot/{self.name}/camera", self.draw.randbytes(self.draw.choice((500, 3000, 9000))))
        if self.draw.random() < 0.3:
            self.session.put(f"robot/{self.name}/pose", self.draw.randbytes(100))

    def decided(self):
        return self.daemon.recording.describe()["events"]

    def searched(self):
        return self.daemon._loop.core.gate.decisions.made

    def told(self, order):
        """Tell the daemon to record or not, as `sendworthy record` does."""
        (reply,) = self.session.get(keys.record(self.name), payload=json.dumps({"record": order}), timeout=60.0)
        return json.loads(reply.ok.payload.to_string())


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Recordings of two robots that contend for one limit, whose specs are reloaded meanwhile."""
    folder = tmp_path_factory.mktemp("robots")
    with ExitStack() as stack:
        one = Robot(stack, "r1", folder)
        robots = one, Robot(stack, "r2", folder, connect=(one.mesh,))
        wait_until(
            lambda: all(len(robot.daemon._loop.core.view.peers) == 1 for robot in robots), what="the other robot"
        )
        fly(robots, 250)
        for robot in robots:
            robot.file.write_text(TIGHTER)
            robot.daemon.reloading.reload("test")
        fly(robots, 500, searches=60)
    return folder / "recordings"


def fly(robots, events, beside=None, searches=0):
    """Publish until each robot has recorded so many events, and so many searches more decided; one may do so beside."""
    pace = threading.Event()
    begun = [robot.searched() for robot in robots]

    def enough():
        for robot in robots if beside is None else (*robots, beside):
            robot.publish()
        pace.wait(0.015)
        searched = [robot.searched() - before for robot, before in zip(robots, begun, strict=True)]
        return min(searched) >= searches and all(robot.decided() >= events for robot in robots)

    wait_until(enough, what=f"{events} events")


@pytest.fixture(scope="module")
def middle(tmp_path_factory):
    """Recordings of the middle of two robots' lives.

    One was told to record twice, the other one's daemon deleted the first of its files.
    """
    folder = tmp_path_factory.mktemp("middle")
    with ExitStack() as stack:
        one = Robot(stack, "r1", folder, on=False)
        two = Robot(stack, "r2", folder, connect=(one.mesh,), file_bytes=300_000, disk_bytes=1_000_000)
        wait_until(lambda: all(len(each.daemon._loop.core.view.peers) == 1 for each in (one, two)), what="the other")
        fly((two,), 200, beside=one)
        one.told("start")
        fly((one,), 300, beside=two)
        for robot in (one, two):
            robot.file.write_text(TIGHTER)
            robot.daemon.reloading.reload("test")
        fly((one, two), 600, searches=20)
        one.told("stop")
        one.told("start")
        fly((one, two), 200, searches=20)
        one.told("stop")
    return folder / "recordings"


def recording(folder, robot):
    (file,) = folder.glob(f"{robot}-*.mcap")
    return RecordingReader(file)


@pytest.mark.full
@pytest.mark.parametrize("robot", ["r1", pytest.param("r2", marks=pytest.mark.full)])
def test_a_real_daemon_s_decisions_are_the_same_to_the_last(folder, robot):
    """Every plan and every command, over a reload of the specs."""
    reader = recording(folder, robot)
    found = replayed([reader])
    assert (found.difference, found.ended, reader.problems) == ("", "", [])
    assert found.events >= 500
    assert found.decisions > 50
    assert found.commands > found.decisions
    generations = {
        entry.event.specs.generation for entry in reader if type(getattr(entry, "event", None)) is ev.SpecsChanged
    }
    assert len(generations) == 1
    assert generations != {reader.start.generation}
    dropped = [
        each for entry in reader if isinstance(entry, Happened) for each in entry.commands if each["command"] == "Drop"
    ]
    assert dropped, "nothing was contended for"


@pytest.mark.full
def test_a_recording_from_the_middle_of_a_life_is_replayed_exactly(middle):
    """What `sendworthy record` begins at any time, over a reload of the specs."""
    first, second = sorted(middle.glob("r1-*.mcap"))
    for file, events in ((first, 600), (second, 200)):
        reader = RecordingReader(file)
        assert not reader.start.whole
        found = replayed([reader])
        assert (found.difference, found.ended, reader.problems) == ("", "", [])
        assert found.events >= events
        assert found.decisions > 10


@pytest.mark.full
def test_rotated_files_are_replayed_exactly_without_those_before_them(middle):
    """All that are left together, and each alone."""
    readers = [RecordingReader(file) for file in sorted(middle.glob("r2-*.mcap"))]
    assert len(readers) > 1
    assert readers[0].start.number > 0
    together = replayed(readers)
    assert (together.difference, together.ended) == ("", "")
    assert together.first == readers[0].start.number
    alone = [replayed([reader]) for reader in readers]
    assert all((found.difference, found.ended) == ("", "") for found in alone)
    assert [found.first for found in alone] == [reader.start.number for reader in readers]
    assert sum(found.events for found in alone) == together.events
    assert sum(found.decisions for found in alone) > 10


@pytest.mark.parametrize("seed", ["1", "2"])
@pytest.mark.full
def test_another_process_finds_the_same(middle, seed):
    """Whatever the order of sets is there."""
    files = sorted(middle.glob("*.mcap"))
    command = "import sys; from proxy.cli import main; sys.exit(main(sys.argv[1:]))"
    done = subprocess.run(
        [sys.executable, "-c", command, "replay", *files],
        env={**os.environ, "PYTHONHASHSEED": seed},
        capture_output=True,
        text=True,
        check=False,
        timeout=120.0,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count(", all equal") == 3


@pytest.mark.full
def test_after_a_gap_the_next_snapshot_is_gone_on_with(middle):
    """Each stretch is told of."""
    first, *_, last = [RecordingReader(file) for file in sorted(middle.glob("r2-*.mcap"))]
    at = first.start.number + 30
    lost = Gap(at, 1, reason="a full disk")
    lacking = [lost if isinstance(each, Happened) and each.number == at else each for each in first]
    before, after = stretches([Lacking(first.start, lacking), last])
    assert (before.equal, before.first, before.events) == (True, first.start.number, 30)
    assert before.ended.endswith("a full disk")
    assert (after.equal, after.ended, after.first) == (True, "", last.start.number)


class Lacking(list):
    """The entries of a file some of which are missing."""

    def __init__(self, start, entries):
        super().__init__(entries)
        self.start = start


@pytest.mark.full
def test_a_snapshot_that_is_refused_is_told(middle):
    """Of another version, or of what is no core."""
    reader = RecordingReader(next(middle.glob("r1-*.mcap")))
    for change, message in (({"version": "0.0.1"}, "one of Sendworthy 0.0.1"), ({"data": b"x"}, "is damaged")):
        changed = [replace(each, **change) if isinstance(each, Snapshot) else each for each in reader]
        with pytest.raises(RecordingError, match=message):
            replayed([Lacking(reader.start, changed)])


def rewritten(folder, change, path):
    """Write a recording anew with changed entries; return its reader."""
    reader = recording(folder, "r1")
    with RecordingWriter(path, reader.start) as writer:
        for entry in map(change, reader):
            if isinstance(entry, Happened):
                writer.happened(entry.event, [dict(each) for each in entry.commands], entry.fault)
            elif isinstance(entry, Gap):
                writer.gap(entry, 0.0)
            elif type(entry).__name__ == "SpecsText":
                writer.specs(entry)
    return RecordingReader(path)


def test_another_plan_is_a_difference(folder, tmp_path):
    """It says which, and how it differs."""

    def change(entry):
        if isinstance(entry, Happened) and isinstance(entry.event, ev.DecisionReady) and entry.event.plan:
            plan = replace(entry.event.plan, utility=entry.event.plan.utility + 1.0)
            return replace(entry, event=replace(entry.event, plan=plan))
        return entry

    found = replayed([rewritten(folder, change, tmp_path / "a.mcap")])
    assert not found.equal
    assert "DecisionReady" in found.difference
    assert "has another plan: utility was" in found.difference


@pytest.mark.parametrize(
    ("commands", "message"),
    [
        (lambda each: {**each, "sample": -1}, "Forward: sample was -1"),
        (lambda _: None, r"asked for, and \d+ are now|command was"),
    ],
)
def test_other_commands_are_a_difference(folder, tmp_path, commands, message):
    """Another one, or one too few."""

    def change(entry):
        if isinstance(entry, Happened) and any(each["command"] == "Forward" for each in entry.commands):
            changed = [commands(each) if each["command"] == "Forward" else each for each in entry.commands]
            return replace(entry, commands=tuple(each for each in changed if each is not None))
        return entry

    found = replayed([rewritten(folder, change, tmp_path / "a.mcap")])
    assert re.search(message, found.difference)


def test_a_fault_that_does_not_happen_again_is_a_difference(folder, tmp_path):
    """And one that did not happen then."""
    faulty = rewritten(
        folder,
        lambda entry: replace(entry, fault="KeyError: 1") if isinstance(entry, Happened) else entry,
        tmp_path / "a.mcap",
    )
    assert 'it was "KeyError: 1", and is "" now' in replayed([faulty]).difference


def test_a_replay_ends_where_something_is_missing(folder, tmp_path):
    """What comes before is compared."""

    def change(entry):
        if isinstance(entry, Happened) and entry.number == 300:
            return Gap(300, 1, 1, 0, "a full disk")
        return entry

    found = replayed([rewritten(folder, change, tmp_path / "a.mcap")])
    assert (found.equal, found.events) == (True, 300)
    assert found.ended == "1 events are missing from number 300 on: a full disk"


def test_a_replay_ends_at_a_damaged_place(folder):
    """The events in there are not in the file, nor any word of that."""
    reader = recording(folder, "r1")
    replay = SameReplay(reader.start)
    for entry in reader:
        if not (isinstance(entry, Happened) and entry.number == 200) and not replay.take(entry):
            break
    assert replay.found.ended == "events are missing from number 200 on"


@pytest.mark.full
def test_files_of_a_life_are_one_recording(folder, tmp_path):
    """Whatever order they are named in; one that is not the next ends the replay."""
    reader = recording(folder, "r1")
    paths = [tmp_path / f"{place}.mcap" for place in range(3)]
    happened = [entry for entry in reader if isinstance(entry, Happened)]
    specs = [entry for entry in reader if type(entry).__name__ == "SpecsText"]
    third = len(happened) // 3
    for place, path in enumerate(paths):
        part = happened[place * third : (place + 1) * third]
        with RecordingWriter(path, replace(reader.start, number=part[0].number, whole=place == 0)) as writer:
            for each in specs:
                writer.specs(each)
            for each in part:
                writer.happened(each.event, [dict(command) for command in each.commands])
    other = recording(folder, "r2")
    files = [RecordingReader(path) for path in reversed(paths)]
    mine, others = lives([*files, other])
    assert [file.path for file in mine] == paths
    assert others == [other]
    found = replayed(mine)
    assert (found.equal, found.ended, found.events) == (True, "", 3 * third)
    assert replayed([mine[0], mine[2]]).ended == f"the next file begins with event {2 * third:,}, not with {third:,}"


def test_what_cannot_be_replayed_is_refused(tmp_path):
    """Mere traffic, the middle of a life, and one whose specs are not there."""
    with pytest.raises(RecordingError, match="mere traffic"):
        replayed([RecordingReader(recorded(tmp_path / "a.mcap", 0, Start("traffic")))])
    whole = RecordingReader(recorded(tmp_path / "b.mcap")).start
    with pytest.raises(RecordingError, match="in the middle of a daemon's life"):
        replayed([RecordingReader(recorded(tmp_path / "c.mcap", 1, replace(whole, whole=False)))])
    with pytest.raises(RecordingError, match="the specs abc are not in the recording"):
        replayed([RecordingReader(recorded(tmp_path / "d.mcap", 1, replace(whole, generation="abc")))])


def test_an_answer_that_nobody_asked_for_is_passed_on(folder):
    """As the daemon's core got it."""
    reader = recording(folder, "r1")
    replay = SameReplay(reader.start)
    assert replay.take(next(entry for entry in reader if type(entry).__name__ == "SpecsText"))
    plan = Plan(True, (0,), 1.0, None, 1, 1)
    event = ev.DecisionReady(reader.start.now, 99, plan)
    replay.take(Happened(0, event))
    assert replay.found.events == 1
