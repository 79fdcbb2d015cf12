"""The file of events."""

from studies.demo.events import (
    Counts,
    Links,
    Publish,
    Receive,
    Run,
    Serve,
    from_line,
    read_events,
    to_line,
    write_events,
)

EVENTS = [
    Run("with", 100.0, 4.0, ("r1", "r2"), 3e6, 2.7e6, 1.0),
    Publish("with", "r1", 0, 100.1, 35_000, 0.25),
    Receive("with", "r1", 0, 100.3, 100.1, 35_000),
    Serve("with", 100.2, "r1", "operator", 4096),
    Counts("with", "r1", 4, 2, 2, 0),
    Links("with", 101.0, 6, 0),
]


def test_events_come_back_from_a_file_as_they_were(tmp_path):
    """Nothing is lost or rounded."""
    path = tmp_path / "events.jsonl"
    write_events(path, EVENTS)
    assert list(read_events(path)) == EVENTS


def test_a_line_that_was_cut_short_is_left_out(tmp_path):
    """A process that was ended while writing spoils nothing but its last line."""
    path = tmp_path / "events.jsonl"
    path.write_text(to_line(EVENTS[1]) + to_line(EVENTS[2])[:20])
    assert list(read_events(path)) == [EVENTS[1]]


def test_a_process_need_not_know_its_phase():
    """The reader says it for those who wrote without."""
    line = '{"event": "links", "t": 1.0, "medium": 6, "direct": 2}'
    assert from_line(line, "without") == Links("without", 1.0, 6, 2)
