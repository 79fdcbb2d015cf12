"""What recordings hold, as samples."""

from dataclasses import replace

import pytest

from planner import Plan
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Drop, Forward
from proxy.recording.entries import Payload, SpecsText, Start, Traffic
from proxy.recording.reading import RecordingReader
from proxy.recording.writing import RecordingWriter
from studies.replay.errors import ReplayError
from studies.replay.recordings import Recordings, opened
from studies.replay.samples import Fate, Passed, Sample
from tests.proxy.recording.lives import START, published


def write(path, begin, *steps):
    with RecordingWriter(path, begin) as writer:
        for step in steps:
            step(writer)
    return path


def traffic(path, *samples, payload=None):
    def add(robot, t):
        def step(writer):
            if payload is not None:
                writer.payload(Payload(0, "a/b", payload), "", t)
            writer.traffic(Traffic(robot, "a/b", t, 10, {"red": t}))

        return step

    return write(path, Start("traffic"), *(add(*each) for each in samples))


def test_traffic_of_several_files_is_in_order(tmp_path):
    """With the features that were recorded, or the payload."""
    one = traffic(tmp_path / "1.mcap", ("r1", 1.0), ("r1", 3.0))
    other = traffic(tmp_path / "2.mcap", ("r2", 2.0), ("r3", 2.5), payload=b"{}")
    recordings = Recordings([RecordingReader(one), RecordingReader(other)])
    found = recordings.survey()
    assert found.samples == {"r1": 2, "r2": 1, "r3": 1}
    assert (found.first, found.last, found.seconds) == (1.0, 3.0, 2.0)
    assert found.specs is None
    assert found.problems == []
    assert list(recordings.told({"r1", "r2"})) == [
        Sample("r1", "a/b", 1.0, 1.0, 10, {"red": 1.0}),
        Sample("r2", "a/b", 2.0, 2.0, 10, {"red": 2.0}, payload=b"{}"),
        Sample("r1", "a/b", 3.0, 3.0, 10, {"red": 3.0}),
    ]


def test_a_robots_recording_tells_what_became_of_its_samples(tmp_path):
    """And what passed besides; deletions are no samples."""
    plan = Plan(True, (), 1.0, None, 3, 4, seconds=0.25)
    deleted = replace(published(3, now=4.0), delete=True)
    path = write(
        tmp_path / "r1.mcap",
        START,
        lambda w: w.specs(SpecsText("abc")),
        lambda w: w.payload(Payload(1, "robot/r1/camera", b"p"), "", 2.0),
        lambda w: w.happened(replace(published(1, now=2.0, red=0.5), superseded=2)),
        lambda w: w.happened(ev.DecisionReady(2.5, 1, plan), [Forward(1)]),
        lambda w: w.happened(published(2, now=3.0), [Drop(2, "dropped:constraint")]),
        lambda w: w.happened(ev.SamplesPassed(3.5, "passed:no-spec", 4, 400)),
        lambda w: w.happened(ev.SamplesPassed(3.6, "dropped:full", 4, 400)),
        lambda w: w.happened(deleted),
    )
    recordings = Recordings([RecordingReader(path)])
    found = recordings.survey()
    assert (found.samples, found.superseded, found.specs.generation) == ({"r1": 2}, 2, "abc")
    first, fate, second, dropped, passed = recordings.told({"r1"})
    wall = START.wall_offset
    assert first == Sample("r1", "robot/r1/camera", wall + 2.0, wall + 1.999, 1000, {"red": 0.5}, 1, b"p")
    assert fate == Fate("r1", 1, "forwarded", wall + 2.5, 0.25)
    assert (second.number, second.payload) == (2, None)
    assert dropped == Fate("r1", 2, "dropped:constraint", wall + 3.0)
    assert passed == Passed("r1", wall + 3.5, 4, 400)


def test_all_of_a_life_is_on_its_wall_clock_as_that_was_last(tmp_path):
    """A robot that boots without a clock, and is told the time: its first samples are beside those of others."""
    born = replace(START, wall_offset=0.0)
    files = [
        write(
            tmp_path / "1.mcap",
            born,
            lambda w: w.happened(published(1, now=2.0)),
            lambda w: w.happened(ev.ClockChanged(2.5, START.wall_offset)),
        ),
        write(
            tmp_path / "2.mcap",
            replace(START, now=2.5, number=2, whole=False),
            lambda w: w.happened(published(2, now=3.0)),
        ),
        write(tmp_path / "3.mcap", replace(START, robot="r2", zid="z2"), lambda w: w.happened(published(1, now=2.8))),
    ]
    recordings, wall = Recordings([RecordingReader(file) for file in files]), START.wall_offset
    found = recordings.survey()
    assert (found.first, found.last) == (wall + 2.0, wall + 3.0)
    told = [(each.robot, each.t) for each in recordings.told({"r1", "r2"})]
    assert told == [("r1", wall + 2.0), ("r2", wall + 2.8), ("r1", wall + 3.0)]


def test_what_cannot_be_replayed_is_told(tmp_path):
    """No recording, or nothing in it; one that is cut off is read as far as it goes."""
    (tmp_path / "no.mcap").write_bytes(b"x")
    files, problems = opened([tmp_path / "no.mcap", traffic(tmp_path / "none.mcap")])
    assert len(problems) == 1
    assert "no.mcap is no MCAP file" in problems[0]
    with pytest.raises(ReplayError, match=r"none\.mcap: no sample was published in it"):
        Recordings(files).survey()
    path = tmp_path / "cut.mcap"
    with RecordingWriter(path, Start("traffic")) as writer:
        for t in range(10):
            writer.traffic(Traffic("r1", "a", float(t), 10))
            writer.flush()
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 5])
    found = Recordings([RecordingReader(path)]).survey()
    assert 0 < found.samples["r1"] <= 10
    assert found.problems
