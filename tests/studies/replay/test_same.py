"""Exact replays of recordings of real daemons."""

import random
import re
import threading
from contextlib import ExitStack
from dataclasses import replace

import pytest

from planner import Plan
from proxy.config import AppConfig, Config, MeshConfig, RecordConfig, SpecsConfig
from proxy.core.interface import events as ev
from proxy.daemon import Daemon
from proxy.recording.entries import Gap, Happened, Start
from proxy.recording.errors import RecordingError
from proxy.recording.reading import RecordingReader
from proxy.recording.writing import RecordingWriter
from proxy.reloading import read_specs
from studies.replay.same import SameReplay, lives, replayed
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

    def __init__(self, stack, name, folder, connect=()):
        self.name, self.app, self.mesh = name, free_endpoint(), free_endpoint()
        self.file = folder / f"{name}.toml"
        self.file.write_text(TIGHT)
        config = Config(
            robot=name,
            app=AppConfig(listen=(self.app,)),
            mesh=MeshConfig(listen=(self.mesh,), connect=connect, scouting=False),
            specs=SpecsConfig(path=self.file),
            record=RecordConfig(on=True, folder=folder / "recordings", payloads=True),
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
        fly(robots, 400)
        for robot in robots:
            robot.file.write_text(TIGHTER)
            robot.daemon.reloading.reload("test")
        fly(robots, 800)
    return folder / "recordings"


def fly(robots, events):
    """Publish until each robot has recorded so many events."""

    pace = threading.Event()

    def enough():
        for robot in robots:
            robot.publish()
        pace.wait(0.015)
        return all(robot.decided() >= events for robot in robots)

    wait_until(enough, what=f"{events} events")


def recording(folder, robot):
    (file,) = folder.glob(f"{robot}-*.mcap")
    return RecordingReader(file)


@pytest.mark.parametrize("robot", ["r1", "r2"])
def test_a_real_daemon_s_decisions_are_the_same_to_the_last(folder, robot):
    """Every plan and every command, over a reload of the specs."""
    reader = recording(folder, robot)
    found = replayed([reader])
    assert (found.difference, found.ended, reader.problems) == ("", "", [])
    assert found.events >= 800
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
