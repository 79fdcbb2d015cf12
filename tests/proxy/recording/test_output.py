"""Writing one file after the other, and what is said where that cannot be done."""

import resource
import shutil
from contextlib import contextmanager
from dataclasses import replace
from random import Random

import pytest
from mcap.reader import make_reader

from proxy.bridge.payloads import Content
from proxy.core.interface import events as ev
from proxy.recording.entries import End, Gap, Happened, Payload, Snapshot, SpecsText, Start
from proxy.recording.folder import RecordingFolder
from proxy.recording.missing import Missing
from proxy.recording.output import Head, Output, text_of
from proxy.recording.tuning import RecordingTuning
from tests.proxy.recording.lives import START, entries, published
from tests.waiting import wait_until
from utility_specs import Specs, load_specs

SPECS = '[[information_type]]\nname = "a"\nkeys = ["a/**"]\nutility = { kind = "video" }\n'


@pytest.fixture
def output(tmp_path):
    """Writes into `tmp_path`, files of at most 20 kB of which there may be 1 MB."""
    output = Output(START, Specs.empty(), RecordingFolder(tmp_path, "r1", 1_000_000, 0.0), 20_000)
    output.open()
    return output


def add(output, numbers, payload=None):
    for number in numbers:
        output.add((number, published(number, red=1 / (number + 3)), (), "", payload))


def files(folder):
    return sorted(folder.glob("*.mcap"))


@contextmanager
def files_end_at(size):
    """No file grows beyond `size` [B]: as on a full disk."""
    _, hard = before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def covered(found):
    """Return how many events are there, and the gaps; together they are all, in their order."""
    due, events, gaps = 0, 0, []
    for entry in found:
        if isinstance(entry, Happened):
            assert entry.number == due
            due, events = due + 1, events + 1
        elif isinstance(entry, Gap):
            assert entry.first == due
            due += entry.events
            gaps.append(entry)
    return due, events, gaps


def test_what_is_added_is_written(output, tmp_path):
    """With the specs in force, and its end."""
    add(output, range(100))
    output.close("stopped")
    (file,) = files(tmp_path)
    found, problems = entries(file)
    assert not problems
    assert found[0] == Start(**{name: getattr(START, name) for name in START.__slots__} | {"generation": "0" * 12})
    assert found[1] == SpecsText("0" * 12)
    assert found[-1] == End(100, "stopped")
    assert covered(found) == (100, 100, [])
    assert (output.written.file, output.written.files, output.written.missing) == (str(file), 1, 0)
    assert output.written.bytes == file.stat().st_size


def headed(output, number):
    """Give what it asked for, if it did: a snapshot of the core before the event with that number."""
    if output.heads > output.given:
        output.add(Head(Snapshot(number, 1.0, "0" * 12, "1", "3", b"core")))
        output.given = output.heads


def test_large_files_are_followed_by_others(output, tmp_path):
    """Each begins where the last one ended, with what the core knew there; the core began with the first alone."""
    output.given = 0
    for begin in range(0, 3000, 100):
        headed(output, begin)
        add(output, range(begin, begin + 100))
        output.flush()
    output.close("stopped")
    due = 0
    for place, file in enumerate(files(tmp_path)):
        found, problems = entries(file)
        assert not problems
        assert (found[0].number, found[0].whole) == (due, place == 0)
        snapshots = [(each.number, each.data) for each in found[2:3] if isinstance(each, Snapshot)]
        assert snapshots == ([(due, b"core")] if place else [])
        due += sum(isinstance(entry, Happened) for entry in found)
    assert place > 0
    assert due == 3000


def test_another_file_begins_when_the_wall_clock_was_set(output, tmp_path):
    """As of a robot that boots without one: times are right from there on. A correction of milliseconds is none."""
    output.given, right = 0, START.wall_offset + 1e8
    for number, offset in enumerate((START.wall_offset + 5e-3, right, right + 5e-3)):
        output.add((2 * number, ev.ClockChanged(1.0 + number, offset), (), "", None))
        output.flush()
        headed(output, 2 * number + 1)
        add(output, [2 * number + 1])
    output.close("stopped")
    found = [entries(file)[0] for file in files(tmp_path)]
    assert [(each[0].wall_offset, each[0].number) for each in found] == [(START.wall_offset, 0), (right, 3)]
    with files(tmp_path)[1].open("rb") as file:
        times = [message.log_time for *_, message in make_reader(file).iter_messages(topics="events/SamplePublished")]
    assert times == [int((published(number).now + right) * 1e9) for number in (3, 5)]


@pytest.mark.full
@pytest.mark.parametrize("size", [200, 20_000, 200_000])
def test_the_least_bound_keeps_the_file_before(tmp_path, size):
    """All take twice what a file may, at most, and of a rotated recording there always is more than the last file."""
    most = 1024 * 1024
    output = Output(START, Specs.empty(), RecordingFolder(tmp_path, "r1", 2 * most, 0.0), most)
    output.open()
    output.given = 0
    noise = Random(1)
    content = Content(size, lambda: (noise.randbytes(size), ""))
    for number in range(5 * most // (size + 200)):
        headed(output, number)
        add(output, [number], content)
        found = [file.stat().st_size for file in files(tmp_path)]
        assert sum(found) <= 2 * most
        assert len(found) >= min(output.written.files, 2)
    output.close("stopped")
    assert output.written.files > 3
    assert all(file.stat().st_size <= most for file in files(tmp_path))


def test_a_file_of_many_keys_is_followed_by_another(output, tmp_path, monkeypatch):
    """Each key of payloads takes a channel of the file, of which there are 65,535: the next one ended the recording."""
    monkeypatch.setattr("proxy.recording.output.TUNING", RecordingTuning(channels=20))
    output.given = 0
    for number in range(100):
        headed(output, number)
        event = replace(published(number), key=f"robot/r1/object/{number}")
        output.add((number, event, (), "", Content(1, lambda: (b"x", ""))))
        output.flush()
    output.close("stopped")
    found = [entries(file) for file in files(tmp_path)]
    assert len(found) > 4
    assert not any(problems for _, problems in found)
    assert sum(isinstance(entry, Payload) for each, _ in found for entry in each) == 100


def test_specs_that_change_are_written_before_their_event(output, tmp_path):
    """As they were read, and again at the begin of later files."""
    (tmp_path / "specs.toml").write_text(SPECS)
    specs = load_specs(tmp_path / "specs.toml")
    output.add((0, ev.SpecsChanged(1.0, specs), (), "", None))
    output.close("stopped")
    found = entries(files(tmp_path)[0])[0]
    assert found[2] == text_of(specs)
    assert found[2].files[0].text == SPECS
    assert found[3].event.specs.generation == specs.generation


def test_payloads_stand_before_their_samples(output, tmp_path):
    """They are read when they are written."""
    add(output, [0], Content(3, lambda: (b"abc", "text/plain")))
    output.close("stopped")
    _, _, payload, sample, _ = entries(files(tmp_path)[0])[0]
    assert (payload.data, payload.sample, sample.number) == (b"abc", 0, 0)


def test_what_others_left_out_stands_in_a_gap(output, tmp_path):
    """Where it belongs."""
    missing = Missing("too much")
    missing.event(10, published(10))
    add(output, range(10))
    output.add(missing)
    add(output, range(11, 20))
    output.close("stopped")
    found, problems = entries(files(tmp_path)[0])
    assert not problems
    assert covered(found) == (20, 19, [Gap(10, 1, 1, 0, "too much", {"SamplePublished": 1})])
    assert output.written.missing == 1


def test_on_a_full_disk_the_recording_says_what_is_missing(output, tmp_path):
    """It goes on when there is room again, and loses nothing else."""
    add(output, range(100))
    output.flush()
    with files_end_at(output.written.bytes + 100):
        add(output, range(100, 200), Content(1, lambda: (b"x", "")))
        output.flush()
        assert output.written.problem == "File too large"
        add(output, range(200, 250), Content(1, lambda: (b"x", "")))
        other = Missing("too much")
        other.event(250, published(250))
        output.add(other)
        output.flush()
        assert output.written.missing == 151

    def goes_on():
        output.flush()
        return not output.stuck

    wait_until(goes_on, what="room again")
    assert output.written.problem  # nothing but that has been written yet
    add(output, range(251, 300))
    output.flush()
    assert not output.written.problem
    output.close("stopped")
    found, problems = entries(files(tmp_path)[0])
    assert not problems
    assert covered(found) == (300, 149, [Gap(100, 151, 151, 150, "File too large", {"SamplePublished": 151})])


def test_a_file_that_somebody_deletes_is_followed_by_another(output, tmp_path, caplog):
    """Which begins with what the core knows, and says what was in hand. The folder may be gone, the disk was full."""
    add(output, range(100))
    output.flush()
    with files_end_at(output.written.bytes):
        add(output, range(100, 150))
        output.flush()
        assert output.written.problem == "File too large"
    shutil.rmtree(tmp_path)
    output.given = output.heads
    output.flush()
    headed(output, 150)
    add(output, range(150, 160))
    output.flush()
    assert not output.written.problem
    add(output, range(160, 200))
    (second,) = files(tmp_path)
    second.unlink()
    output.flush()
    add(output, range(200, 250))
    output.close("stopped")
    assert f"{second} was deleted; another file begins" in caplog.text
    (third,) = files(tmp_path)
    found, problems = entries(third)
    assert not problems
    assert [entry for entry in found if isinstance(entry, Gap)] == [
        Gap(160, 40, 40, 0, "their file was deleted", {"SamplePublished": 40})
    ]
    assert [entry.number for entry in found if isinstance(entry, Happened)] == [*range(200, 250)]
    assert (output.written.files, output.written.missing) == (3, 90)


def test_other_programs_read_a_file_that_a_full_disk_cut(output, tmp_path):
    """As far as it goes: it keeps its end when nothing more can be written, also if the daemon is killed then."""
    add(output, range(100))
    output.flush()
    with files_end_at(output.written.bytes):
        add(output, range(100, 200))
        output.flush()
        assert output.written.missing == 100
        (path,) = files(tmp_path)
        with path.open("rb") as file:
            found = make_reader(file).iter_messages(topics=["events/SamplePublished"])
            assert [message.sequence for *_, message in found] == [*range(100)]
    output.close("stopped")


def test_a_disk_that_stays_full_still_holds_where_the_record_ends(output, tmp_path):
    """The chunk that was written last makes room for it, and is missing, too."""
    for begin in (0, 100):
        add(output, range(begin, begin + 100))
        output.flush()
    with files_end_at(output.written.bytes):
        add(output, range(200, 300))
        output.close("stopped")
    found, problems = entries(files(tmp_path)[0])
    assert not problems
    total, events, (gap,) = covered(found)
    assert (total, events, gap.first, gap.reason) == (300, 100, 100, "File too large")
    assert found[-1] == End(300, "stopped")


@pytest.mark.parametrize("room", [4, 200])
def test_with_no_room_at_all_there_is_no_file_and_no_error(tmp_path, room):
    """The daemon goes on; what is missing is counted, and the first words are of it once there is room."""
    output = Output(START, Specs.empty(), RecordingFolder(tmp_path, "r1", 1_000_000, 0.0), 20_000)
    with files_end_at(room):
        output.open()
        add(output, range(10))
        output.flush()
        assert output.written.missing == 10
        assert output.written.problem == "File too large"
    assert not files(tmp_path)

    def goes_on():
        output.flush()
        return not output.stuck

    wait_until(goes_on, what="room again")
    add(output, range(10, 20))
    output.close("stopped")
    found, problems = entries(files(tmp_path)[-1])
    assert not problems
    assert [type(entry).__name__ for entry in found[:3]] == ["Start", "SpecsText", "Gap"]
    assert (found[0].whole, found[2].first, found[2].events) == (False, 0, 10)


def test_a_folder_that_cannot_be_is_told(tmp_path):
    """A file stands in its way."""
    (tmp_path / "file").write_text("")
    output = Output(START, Specs.empty(), RecordingFolder(tmp_path / "file", "r1", 1000, 0.0), 100)
    output.open()
    add(output, range(3))
    (tmp_path / "specs.toml").write_text(SPECS)
    output.add((3, ev.SpecsChanged(1.0, load_specs(tmp_path / "specs.toml")), (), "", None))
    output.close("stopped")
    assert output.written.problem == f"{tmp_path}/file: File exists"
    assert output.written.missing == 4
