"""Reading recordings: whole ones, and what is left of others."""

import struct

import pytest
from mcap.writer import Writer

from proxy.core.interface import events as ev
from proxy.recording.entries import PROFILE, End, Happened, Start
from proxy.recording.errors import RecordingError
from proxy.recording.reading import RecordingReader
from proxy.recording.tuning import TUNING
from proxy.recording.writing import RecordingWriter
from tests.proxy.recording.lives import START, entries, published, recorded
from utility_specs import Specs


def numbers(found):
    return [entry.number for entry in found if isinstance(entry, Happened)]


def foreign(path, profile, *messages):
    """Write an MCAP file of another program."""
    writer = Writer(str(path))
    writer.start(profile)
    for topic, data in messages:
        schema = writer.register_schema("x", "jsonschema", b"{}")
        channel = writer.register_channel(topic, "json", schema)
        writer.add_message(channel, 0, data, 0)
    writer.finish()
    return path


def test_all_comes_back(tmp_path):
    """Each pass begins anew."""
    reader = RecordingReader(recorded(tmp_path / "a.mcap", events=100, chunks=7))
    for _ in range(2):
        found = list(reader)
        assert found[0] == reader.start == START
        assert found[1:-1] == [Happened(n, published(n, red=1 / (n + 3))) for n in range(100)]
        assert found[-1] == End(100, "done")
        assert not reader.problems


def test_specs_that_change_are_told_by_their_generation(tmp_path):
    """Nothing else of them is known here."""
    with RecordingWriter(tmp_path / "a.mcap", START) as writer:
        writer.happened(ev.SpecsChanged(1.0, Specs.empty()))
    event = entries(tmp_path / "a.mcap")[0][1].event
    assert (type(event), event.specs.generation) == (ev.SpecsChanged, Specs.empty().generation)


@pytest.mark.parametrize(
    ("content", "message"),
    [(b"", "is empty"), (b"not a recording", "is no MCAP file"), (b"\x89MCAP0\r\n", "has no beginning of a recording")],
)
def test_what_is_no_recording_is_refused(tmp_path, content, message):
    """With a word on what it is."""
    path = tmp_path / "a.mcap"
    path.write_bytes(content)
    with pytest.raises(RecordingError, match=message):
        RecordingReader(path)


def test_what_cannot_be_read_is_refused(tmp_path):
    """A file that is not there, and a folder."""
    with pytest.raises(RecordingError, match="No such file"):
        RecordingReader(tmp_path / "none.mcap")
    with pytest.raises(RecordingError, match="Is a directory"):
        RecordingReader(tmp_path)


@pytest.mark.parametrize(("profile", "named"), [("ros2", ' but of "ros2"'), ("", "")])
def test_another_mcap_is_refused(tmp_path, profile, named):
    """And what can be done with a bag."""
    path = foreign(tmp_path / "a.mcap", profile, ("/chatter", b"{}"))
    with pytest.raises(RecordingError, match=f"no recording of Sendworthy{named}; `sendworthy import`"):
        RecordingReader(path)


def test_a_later_format_is_refused(tmp_path):
    """Nobody can know what it means."""
    path = foreign(tmp_path / "a.mcap", PROFILE, ("start", b'{"format": 2, "kind": "robot"}'))
    with pytest.raises(RecordingError, match="of format 2, and only 1 is understood here"):
        RecordingReader(path)


def test_a_recording_without_a_beginning_is_refused(tmp_path):
    """It begins with something else, or with nothing that can be read."""
    for number, data in enumerate((b"[]", b"nothing")):
        path = foreign(tmp_path / f"{number}.mcap", PROFILE, ("start", data))
        with pytest.raises(RecordingError, match="has no beginning"):
            RecordingReader(path)


def test_messages_that_are_none_are_left_out(tmp_path):
    """What is not understood is told, and what only later versions know is passed over."""
    start = b'{"format": 1, "kind": "traffic"}'
    traffic = b'{"robot": "r1", "key": "k", "t_gen": 1.0, "size": 10}'
    path = foreign(
        tmp_path / "a.mcap",
        PROFILE,
        ("start", start),
        ("traffic", traffic),
        ("traffic", b'{"robot": 3}'),
        ("events/Earthquake", b"{}"),
        ("events/SpecsChanged", b"[]"),
        ("traffic", b"[" * 5000),
        ("weather", b"{}"),
        ("traffic", traffic),
    )
    found, problems = entries(path)
    assert [type(entry).__name__ for entry in found] == ["Start", "Traffic", "Traffic"]
    assert len(problems) == 4
    assert "there is no such event" in problems[1]


@pytest.mark.full
def test_a_file_is_read_as_far_as_it_goes(tmp_path):
    """Wherever it is cut off."""
    whole = recorded(tmp_path / "a.mcap", events=60, chunks=6).read_bytes()
    first = next(size for size in range(len(whole)) if readable(tmp_path, whole[:size]))
    seen = set()
    for size in range(first, len(whole), 37):
        found, problems = entries(cut(tmp_path, whole[:size]))
        seen.add(len(numbers(found)))
        assert numbers(found) == list(range(len(numbers(found))))
        assert problems or isinstance(found[-1], End)
    assert seen >= {10, 20, 30, 40, 50, 60}


def cut(folder, data):
    path = folder / "cut.mcap"
    path.write_bytes(data)
    return path


def readable(folder, data):
    try:
        RecordingReader(cut(folder, data))
    except RecordingError:
        return False
    return True


def test_a_damaged_chunk_is_left_out(tmp_path):
    """The others are read; what is missing is told."""
    whole = bytearray(recorded(tmp_path / "a.mcap", events=60, chunks=6).read_bytes())
    whole[chunk_ends(whole)[2] - 20] ^= 0xFF
    found, problems = entries(cut(tmp_path, whole))
    assert numbers(found) == [*range(20), *range(30, 60)]
    assert "a chunk is damaged and left out" in problems[0]
    assert "10 events are missing before event 30" in problems[1]


def chunk_ends(data):
    """Where the chunks of a file end."""
    at, ends = 8, []
    while data[at] != 0x0F:
        length = struct.unpack_from("<Q", data, at + 1)[0]
        at += 9 + length
        if data[at - 9 - length] == 0x06:
            ends.append(at)
    return ends


@pytest.mark.parametrize(
    ("packing", "size", "data", "message"),
    [
        (b"zstd", TUNING.record + 1, b"", "claims to hold 67,108,865 bytes"),
        (b"lz4", 10, b"xxxx", "another number of bytes than it says"),
        (b"lz4", 10, bytes(16), "LZ4F"),
        (b"bz2", 10, b"xxxx", 'packed by "bz2"'),
        (b"", 4, b"xxxx", "checksum is wrong"),
    ],
)
def test_a_chunk_that_lies_is_left_out(tmp_path, packing, size, data, message):
    """It must not take the memory."""
    whole = recorded(tmp_path / "a.mcap", events=20, chunks=2).read_bytes()
    end = chunk_ends(whole)[0]
    lie = struct.pack("<QQQI", 0, 0, size, 7) + struct.pack("<I", len(packing)) + packing
    lie += struct.pack("<Q", len(data)) + data
    record = struct.pack("<BQ", 0x06, len(lie)) + lie
    found, problems = entries(cut(tmp_path, whole[:end] + record + whole[end:]))
    assert numbers(found) == list(range(20))
    assert message in problems[0]


def test_a_small_chunk_that_unpacks_to_more_is_left_out(tmp_path):
    """It says itself how much it holds, and so does its chunk."""
    zstandard = pytest.importorskip("zstandard")
    whole = recorded(tmp_path / "a.mcap", events=20, chunks=2).read_bytes()
    end, data = chunk_ends(whole)[0], zstandard.compress(bytes(1_000_000))
    lie = struct.pack("<QQQI", 0, 0, 10, 0) + struct.pack("<I", 4) + b"zstd" + struct.pack("<Q", len(data)) + data
    record = struct.pack("<BQ", 0x06, len(lie)) + lie
    problems = entries(cut(tmp_path, whole[:end] + record + whole[end:]))[1]
    assert "another number of bytes than it says" in problems[0]


@pytest.mark.parametrize("record", [struct.pack("<BQ", 0x06, 1 << 60), bytes(9)])
def test_where_lengths_make_no_sense_reading_ends(tmp_path, record):
    """What comes later cannot be found."""
    whole = recorded(tmp_path / "a.mcap", events=20, chunks=2).read_bytes()
    end = chunk_ends(whole)[0]
    found, (problem,) = entries(cut(tmp_path, whole[:end] + record + whole[end:]))
    assert len(numbers(found)) == 10
    assert f"is damaged at byte {end:,} and is read up to there" in problem


def test_a_header_that_is_none_is_refused(tmp_path):
    """The file begins like MCAP, and then goes on otherwise."""
    whole = recorded(tmp_path / "a.mcap").read_bytes()
    path = cut(tmp_path, whole[:8] + struct.pack("<BQ", 0x01, 2) + b"xx")
    with pytest.raises(RecordingError, match="is no recording of Sendworthy"):
        RecordingReader(path)


def test_numbers_go_round(tmp_path):
    """Events are numbered modulo 2³² in files."""
    with RecordingWriter(tmp_path / "a.mcap", Start("robot", number=2**32 - 1)) as writer:
        for number in range(3):
            writer.happened(published(number))
    found, problems = entries(tmp_path / "a.mcap")
    assert numbers(found) == [2**32 - 1, 0, 1]
    assert not problems
