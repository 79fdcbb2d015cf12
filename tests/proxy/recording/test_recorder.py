"""Noting what the core takes in, on one thread, and writing it on another."""

from dataclasses import replace

import pytest

from planner import Constraint, Linear, Message, Problem, Stream
from proxy.bridge.payloads import Content
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Forward
from proxy.recording.entries import Snapshot
from proxy.recording.errors import RecordingError
from proxy.recording.folder import RecordingFolder
from proxy.recording.output import Output
from proxy.recording.recorder import FULL, Recorder
from proxy.recording.tuning import TUNING, RecordingTuning
from tests.proxy.recording.lives import START, entries, published
from tests.waiting import wait_until
from utility_specs import Specs

MESSAGE = Message(0, 0.0, 0.0, 0.1, Linear(1.0, 0.1), 1.0, (100.0,))
PROBLEM = Problem((Stream(0),), (MESSAGE,), 0, (Constraint("throughput", 1.0, 1e3),), (), t_start=0.0, t_end=2.0)


class Core:
    """Forwards samples, and passes those of an even number on; chokes on hand-overs."""

    def handle(self, event):
        if isinstance(event, ev.SampleHanded):
            raise KeyError(event.sample)
        if isinstance(event, ev.SamplePublished):
            return [Forward(event.sample), Decide(0, PROBLEM, 1, 300, event.now)]
        return []

    def pass_on(self, event):
        return None if event.sample % 2 else [Forward(event.sample)]


def look(number, now):
    """Take a snapshot of what would be a core."""
    return Snapshot(number, now, "0" * 12, "1", "3", b"core")


@pytest.fixture
def record(tmp_path):
    """Make recorders; `finish` closes one and returns its entries."""

    def made(payload=None):
        output = Output(START, Specs.empty(), RecordingFolder(tmp_path, "r1", 1 << 30, 0.0), 1 << 26)
        return Recorder(Core(), output, look, payload=payload)

    return made


def finish(recorder, folder):
    recorder.stop()
    assert recorder.wait(60.0)
    found, problems = entries(folder / "r1-19700101T000000Z-0001.mcap")
    assert not problems
    return found


def test_events_are_noted_with_what_follows(record, tmp_path):
    """The caller gets the commands as the core gave them."""
    recorder = record()
    recorder.start()
    assert recorder.begun(60.0)
    commands = recorder.handle(published(0))
    assert commands == Core().handle(published(0))
    recorder.handle(ev.TimePassed(2.0))
    with pytest.raises(KeyError):
        recorder.handle(ev.SampleHanded(2.0, 7))
    first, second, third = finish(recorder, tmp_path)[2:-1]
    assert [each["command"] for each in first.commands] == ["Forward", "Decide"]
    assert first.commands[1]["messages"] == 1
    assert (second.event, second.commands) == (ev.TimePassed(2.0), ())
    assert third.fault == "KeyError: 7"


@pytest.mark.full
def test_a_thousand_samples_a_second_are_all_there(record, tmp_path):
    """And twenty times as many for a moment."""
    recorder = record()
    recorder.start()
    for begin in range(0, 20_000, 2000):
        for number in range(begin, begin + 2000):
            recorder.handle(published(number))
        wait_until(lambda: recorder.waiting < 1000, what="the writer")
    assert recorder.describe()["missing"] == 0
    found = finish(recorder, tmp_path)
    assert [entry.number for entry in found[2:-1]] == list(range(20_000))


def test_what_is_more_than_can_be_written_is_said_to_be_missing(record, tmp_path):
    """Nobody waits for the writer, which does not run yet here."""
    recorder, most = record(), TUNING.events
    for number in range(most + 10):
        recorder.handle(published(number))
    assert recorder.describe()["missing"] == 10
    recorder.start()
    wait_until(lambda: not recorder.waiting, what="the writer")
    recorder.handle(published(most + 10))
    *_, gap, last, _ = finish(recorder, tmp_path)
    assert (gap.first, gap.events, gap.samples, gap.reason) == (most, 10, 10, FULL)
    assert last.number == most + 10


def test_what_is_missing_at_the_end_is_said_too(record, tmp_path):
    """The recorder ends before there was room again."""
    recorder = record()
    for number in range(TUNING.events + 10):
        recorder.handle(published(number))
    recorder.start()
    *_, gap, _ = finish(recorder, tmp_path)
    assert (gap.first, gap.events) == (TUNING.events, 10)


def test_payloads_wait_within_a_bound(record, tmp_path):
    """What is beyond is missing, while its event is there; deletions and samples that are gone have none."""
    size = TUNING.payload_bytes // 3
    contents = {0: size, 1: size, 2: size, 3: size}

    def payload(sample):
        return Content(contents[sample], lambda: (b"%d" % sample, "")) if sample in contents else None

    recorder = record(payload)
    for number in range(5):
        recorder.handle(published(number))
    recorder.handle(ev.TimePassed(3.0))
    recorder.start()
    wait_until(lambda: not recorder.waiting, what="the writer")
    recorder.handle(published(0))
    found = finish(recorder, tmp_path)
    names = [type(entry).__name__ for entry in found[2:]]
    assert names == ["Payload", "Happened"] * 3 + ["Gap"] + ["Happened"] * 3 + ["Payload", "Happened", "End"]
    assert (found[8].events, found[8].payloads) == (0, 1)


def test_payloads_that_fill_a_chunk_are_written_at_once(record, tmp_path, monkeypatch):
    """Else what waits would make a file larger than it may be, before it is seen that it is full."""
    monkeypatch.setattr("proxy.recording.recorder.TUNING", RecordingTuning(flush=3600.0))
    recorder = record(lambda _: Content(TUNING.chunk // 2, lambda: (b"x", "")))
    recorder.start()
    assert recorder.begun(60.0)
    for number in range(2):
        recorder.handle(published(number))
    wait_until(lambda: not recorder.waiting, what="the writer")
    assert len(finish(recorder, tmp_path)) == 7


def test_an_error_ends_the_recording_and_nothing_else(record, tmp_path, caplog):
    """The file can be read, all that is not there counts as missing, and the status says why."""

    def fails():
        raise ValueError("gone")

    recorder = record(lambda sample: Content(1, fails) if sample == 2 else None)
    for number in range(10):
        recorder.handle(published(number))
    recorder.start()
    assert recorder.wait(60.0)
    for number in range(10, 20):
        recorder.handle(published(number))
        recorder.pass_on(published(20))
    told = recorder.describe()
    assert (told["events"], told["missing"], told["problem"]) == (30, 30, "ValueError: gone")
    assert recorder.waiting == 0
    assert recorder.begun(0.0)
    assert "recording ends, for an error" in caplog.text
    found, _ = entries(tmp_path / "r1-19700101T000000Z-0001.mcap")
    assert [type(entry).__name__ for entry in found] == ["Start", "SpecsText"]


def test_what_waits_is_written_soon(record, tmp_path):
    """A daemon that is killed loses a second of its record, or so."""
    recorder = record()
    recorder.start()
    recorder.handle(published(0))

    def there():
        try:
            return any(len(entries(file)[0]) == 3 for file in tmp_path.glob("*.mcap"))
        except RecordingError:  # it is there, and its beginning is still to be written
            return False

    wait_until(there, what="the event in the file")
    finish(recorder, tmp_path)


def test_what_is_passed_on_is_noted_like_all_else(record, tmp_path):
    """Where the core does not pass an event on nothing has happened yet."""
    recorder = record()
    recorder.start()
    assert recorder.pass_on(published(0)) == [Forward(0)]
    assert recorder.pass_on(published(1)) is None
    recorder.handle(published(1))
    _, _, *happened, _ = finish(recorder, tmp_path)
    assert [(entry.number, entry.event.sample) for entry in happened] == [(0, 0), (1, 1)]
    assert [command["command"] for command in happened[0].commands] == ["Forward"]


@pytest.mark.full
def test_a_recording_of_the_middle_of_a_life_begins_with_what_the_core_knew(tmp_path):
    """Before its first event; each snapshot that is asked for stands where the core was then."""
    output = Output(replace(START, whole=False), Specs.empty(), RecordingFolder(tmp_path, "r1", 1 << 30, 0.0), 20_000)
    recorder = Recorder(Core(), output, look)
    recorder.start()
    wait_until(lambda: output.written.files == 1, what="a file")
    for number in range(2000):
        recorder.handle(published(number, red=1 / (number + 3)))
        if number % 100 == 99:
            wait_until(lambda: not recorder.waiting, what="all to be written")
    recorder.stop()
    assert recorder.wait(60.0)
    files = sorted(tmp_path.glob("*.mcap"))
    assert len(files) > 1
    for file in files:
        begin, _, snapshot, first, *_ = entries(file)[0]
        assert (snapshot.number, snapshot.data) == (begin.number, b"core")
        assert (first.number, first.event.now) == (begin.number, snapshot.now)
    assert recorder.describe()["problem"] == ""


def test_without_a_snapshot_the_recording_goes_on(tmp_path, caplog):
    """Its status and the log say why there is none, once; the core hears nothing of it."""

    def fails(number, now):
        raise RecordingError(f"no {number} at {now}")

    output = Output(replace(START, whole=False), Specs.empty(), RecordingFolder(tmp_path, "r1", 1 << 30, 0.0), 1 << 26)
    recorder = Recorder(Core(), output, fails)
    recorder.start()
    assert len(recorder.handle(published(0))) == 2
    recorder.handle(published(1))
    problem = "it cannot be replayed exactly, for there is no snapshot of the core: no 0 at 1.0"
    assert recorder.describe()["problem"] == problem
    assert [record.message for record in caplog.records] == [f"recording: {problem}"]
    found = finish(recorder, tmp_path)
    assert [type(entry).__name__ for entry in found] == ["Start", "SpecsText", "Happened", "Happened", "End"]
