"""Writing recordings: what other programs make of them."""

import json
from contextlib import suppress

import pytest
from mcap.reader import make_reader

from planner import Constraint, Linear, Message, Problem, Stream
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Forward, SendDigest
from proxy.core.protocol.messages import Digest
from proxy.recording.entries import Gap, Happened, Payload, SpecFile, SpecsText
from proxy.recording.writing import RecordingWriter, described
from tests.proxy.recording.lives import START, entries, published, recorded


def test_other_programs_read_it(tmp_path):
    """With its index, checksums, schemas, and times on the wall clock."""
    path = recorded(tmp_path / "a.mcap", events=100, chunks=5)
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        assert reader.get_header().profile == "sendworthy"
        statistics = reader.get_summary().statistics
        assert (statistics.message_count, statistics.chunk_count) == (102, 6)
        found = list(reader.iter_messages(topics=["events/SamplePublished"]))
    schema, channel, message = found[10]
    assert len(found) == 100
    assert (channel.message_encoding, schema.encoding, schema.name) == (
        "json",
        "jsonschema",
        "sendworthy.SamplePublished",
    )
    assert json.loads(schema.data)["properties"]["size"] == {"type": "integer"}
    assert message.log_time == round((1.0 + 10 * 0.01 + 1.7e9) * 1e9)
    assert json.loads(message.data)["features"] == {"red": 1 / 13}
    assert message.sequence == 10


def test_other_programs_read_what_was_not_closed(tmp_path):
    """While it is written, and when whoever wrote it was killed; what comes next takes the place of the end."""
    path = tmp_path / "a.mcap"
    writer = RecordingWriter(path, START)
    for number in range(3):
        writer.happened(published(number))
        writer.flush()
        with path.open("rb") as file:
            found = make_reader(file, validate_crcs=True).iter_messages(topics=["events/SamplePublished"])
            assert [message.sequence for *_, message in found] == [*range(number + 1)]
        _, problems = entries(path)
        assert problems == [f"{path} was not closed: its last events may be missing"]
    writer.abandon()


def test_what_followed_stands_with_the_event(tmp_path):
    """Commands in their order, or the fault that the core made."""
    digest = Digest("r1", "z1", 1.0)
    with RecordingWriter(tmp_path / "a.mcap", START) as writer:
        writer.happened(published(0), (Forward(0), SendDigest(digest)))
        writer.happened(ev.SampleHanded(1.0, 0), fault="KeyError: 0")
    first, second = [entry for entry in entries(tmp_path / "a.mcap")[0] if isinstance(entry, Happened)]
    assert first.commands[0] == {"command": "Forward", "sample": 0}
    assert first.commands[1]["digest"]["robot"] == "r1"
    assert (second.commands, second.fault) == ((), "KeyError: 0")


def test_events_written_together_stand_as_if_each_was_written_alone(tmp_path):
    """To the last byte, whether they are written the quick way or not, and behind others of the same chunk."""
    digest = Digest("r1", "z1", 1.0)
    events = [published(0), ev.SampleHanded(1.0, 0), ev.TimePassed(0.9), published(1, red=float("inf"))]
    followed = [(Forward(0), SendDigest(digest)), (), (described(Forward(7)),), (Forward(1),)]
    for count in (3, 4):
        paths = [tmp_path / f"{name}{count}.mcap" for name in ("together", "alone")]
        with RecordingWriter(paths[0], START) as writer:
            writer.happened(published(5))
            writer.all_happened(events[:count], followed[:count])
        with RecordingWriter(paths[1], START) as writer:
            writer.happened(published(5))
            for event, commands in zip(events[:count], followed, strict=False):
                writer.happened(event, commands)
        together, alone = (path.read_bytes() for path in paths)
        assert together == alone


def test_a_problem_is_told_by_its_size():
    """It follows from the events, and is large."""
    messages = tuple(Message(0, t, t, t + 0.1, Linear(1.0, 0.1), 1.0, (100.0,)) for t in (0.0, 1.0))
    problem = Problem((Stream(0),), messages, 0, (Constraint("throughput", 1.0, 1000.0),), (), t_start=0.0, t_end=2.0)
    assert described(Decide(3, problem, 5, 300, 1.5)) == {
        "command": "Decide",
        "ticket": 3,
        "seed": 5,
        "iterations": 300,
        "asked": 1.5,
        "messages": 2,
    }


def test_specs_gaps_and_payloads_stand_between(tmp_path):
    """Each where it belongs; a payload that is JSON is so for others, too."""
    specs = SpecsText("abc", (SpecFile("a.toml", "x = 1"),))
    with RecordingWriter(tmp_path / "a.mcap", START) as writer:
        writer.specs(specs, 1.0)
        writer.payload(Payload(0, "robot/r1/pose", b'{"x": 1}'), "application/json", 1.0)
        writer.happened(published(0))
        writer.payload(Payload(1, "robot/r1/camera", b"\xff\xd8"), "image/jpeg", 1.0)
        writer.gap(Gap(1, 5, 2, 0, "full", {"SamplePublished": 2}), 1.0)
        writer.happened(published(6))
    found, problems = entries(tmp_path / "a.mcap")
    assert not problems
    assert found[1:3] == [specs, Payload(0, "robot/r1/pose", b'{"x": 1}')]
    assert found[4:6] == [Payload(1, "robot/r1/camera", b"\xff\xd8"), Gap(1, 5, 2, 0, "full", {"SamplePublished": 2})]
    assert found[6].number == 6
    with (tmp_path / "a.mcap").open("rb") as file:
        channels = {each.topic: each for each in make_reader(file).get_summary().channels.values()}
    assert channels["payloads/robot/r1/pose"].message_encoding == "json"
    assert channels["payloads/robot/r1/camera"].metadata["encoding"] == "image/jpeg"


def test_a_file_is_never_overwritten(tmp_path):
    """Neither by accident."""
    recorded(tmp_path / "a.mcap")
    with pytest.raises(FileExistsError):
        RecordingWriter(tmp_path / "a.mcap", START)


def test_an_error_leaves_the_file_as_it_is(tmp_path):
    """It can be read as far as it goes, and has no end."""
    with suppress(ZeroDivisionError), RecordingWriter(tmp_path / "a.mcap", START) as writer:
        writer.happened(published(0))
        writer.flush()
        raise ZeroDivisionError
    found, (problem,) = entries(tmp_path / "a.mcap")
    assert len(found) == 2
    assert "was not closed" in problem
