"""The log: one line per event, to read or for programs."""

import io
import json
import logging
import os
import re

import pytest

from proxy import clock
from proxy.config import LogConfig
from proxy.log import AT_ONCE, NEWS_AT_ONCE, PERIOD, REASONS, set_up_logging

log = logging.getLogger("proxy.gate")


@pytest.fixture
def logged(monkeypatch):
    """Set up logging to a buffer; the root logger is put back afterwards."""
    root = logging.getLogger()
    monkeypatch.setattr(root, "level", root.level)
    monkeypatch.setattr(root, "handlers", [])

    def set_up(stream=None, environ=None, **config):
        stream = stream or io.StringIO()
        set_up_logging(LogConfig(**config), environ or {}, stream)
        return stream

    return set_up


@pytest.fixture
def journal(logged, tmp_path):
    """Set up logging to what systemd gave the service for its journal; returns what was written."""
    file = tmp_path / "journal"

    def set_up(**config):
        stream = file.open("w")
        found = os.fstat(stream.fileno())
        logged(stream, {"JOURNAL_STREAM": f"{found.st_dev}:{found.st_ino}"}, **config)
        return stream

    streams = []

    def opened(**config):
        streams.append(set_up(**config))
        return file

    yield opened
    for stream in streams:
        stream.close()


def test_a_line_has_time_level_and_room(logged):
    """On a terminal each line says when, how bad and where."""
    stream = logged()
    log.warning("the limit is %d B", 5)
    assert re.fullmatch(
        r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d,\d{3} WARNING proxy\.gate: the limit is 5 B\n", stream.getvalue()
    )


def test_the_journal_stamps_lines_itself(journal):
    """Under systemd no time is printed twice, and each line has its priority."""
    file = journal(level="debug")
    for level in (logging.DEBUG, logging.INFO, logging.WARNING, logging.ERROR):
        log.log(level, "hello")
    assert file.read_text().splitlines() == [
        "<7>DEBUG proxy.gate: hello",
        "<6>INFO proxy.gate: hello",
        "<4>WARNING proxy.gate: hello",
        "<3>ERROR proxy.gate: hello",
    ]


def test_what_a_service_starts_may_write_elsewhere(logged, tmp_path):
    """It has the variable of the service, but its output is no journal."""
    with (tmp_path / "file").open("w") as stream:
        logged(stream, {"JOURNAL_STREAM": "8:1234"})
        log.info("hello")
    assert not (tmp_path / "file").read_text().startswith("<")


def test_less_than_the_level_is_not_logged(logged):
    """The level is the least that is logged."""
    stream = logged(level="warning")
    log.info("hello")
    assert stream.getvalue() == ""


def test_a_traceback_stays_on_one_line(logged):
    """One event is one line, whatever it holds."""
    stream = logged(level="debug")
    try:
        int("first\nsecond")
    except ValueError:
        logging.getLogger("proxy").exception("it\nfailed")
    (line,) = stream.getvalue().splitlines()
    assert "ERROR proxy: it | failed | Traceback" in line
    assert line.endswith("ValueError: invalid literal for int() with base 10: 'first\\nsecond'")


def test_a_line_moves_no_cursor(logged):
    """Whoever is on the mesh has a name of its own choice, and logs are read on terminals."""
    stream = logged()
    log.info("robot %s is on the mesh", "\x1b[2Jred\x9b2J")
    assert stream.getvalue().endswith("robot \ufffd[2Jred\ufffd2J is on the mesh\n")


def test_programs_read_objects(logged):
    """With the time in UTC, the level, the message, and what is given beside it."""
    stream = logged(format="json")
    log.warning("%d dropped", 5, extra={"reason": "dropped:full", "new": 5})
    line = json.loads(stream.getvalue())
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z", line.pop("ts"))
    assert line == {
        "level": "warning",
        "logger": "proxy.gate",
        "message": "5 dropped",
        "reason": "dropped:full",
        "new": 5,
    }


def test_programs_get_tracebacks_whole(logged):
    """Their lines are escaped, so it is one line all the same."""
    stream = logged(format="json")
    try:
        int("x")
    except ValueError:
        log.exception("it\nfailed")
    (text,) = stream.getvalue().splitlines()
    line = json.loads(text)
    assert line["message"] == "it\nfailed"
    assert line["exception"].startswith("Traceback")
    assert line["exception"].endswith("literal for int() with base 10: 'x'")


def test_objects_go_to_the_journal_with_their_priority(journal):
    """The journal takes the priority away, and keeps the object as its message."""
    file = journal(format="json")
    log.error("hello")
    line = file.read_text()
    assert line.startswith("<3>{")
    assert json.loads(line.removeprefix("<3>"))["message"] == "hello"


@pytest.fixture
def time(monkeypatch):
    """A clock that stands still until it is set."""
    now = [0.0]
    monkeypatch.setattr(clock, "monotonic", lambda: now[0])
    return now


def test_the_same_warning_is_not_logged_without_end(logged, time):
    """Whatever its arguments are; after a minute the next one tells how many were left out."""
    stream = logged()
    for number in range(AT_ONCE + 7):
        log.error("cannot handle %d", number)
    log.warning("something else")
    lines = stream.getvalue().splitlines()
    assert len(lines) == AT_ONCE + 1
    assert lines[-1].endswith("something else")
    time[0] = PERIOD
    log.error("cannot handle %d", 99)
    log.error("cannot handle %d", 100)
    *_, first, second = stream.getvalue().splitlines()
    assert first.endswith("cannot handle 99 (7 more like it were left out)")
    assert second.endswith("cannot handle 100")


def test_reasons_are_told_apart(logged, time):
    """By the field, or by the text where that is all there is; programs read what was left out as a field."""
    stream = logged(format="json")
    for number in range(AT_ONCE + 2):
        log.warning("%s", "one text")
        log.warning("%s", "another", extra={"reason": f"dropped:{number}"})
        log.warning("%s", f"text {number}")
    assert len(stream.getvalue().splitlines()) == 3 * AT_ONCE + 4
    time[0] = PERIOD
    log.warning("%s", "one text")
    assert json.loads(stream.getvalue().splitlines()[-1])["left_out"] == 2


def test_of_what_is_no_warning_more_is_logged(logged, time):
    """All robots of a team may appear on the mesh at once, and each is told; not a stranger that comes without end."""
    stream = logged()
    for number in range(NEWS_AT_ONCE + 5):
        log.info("%s", f"robot {number} is on the mesh", extra={"reason": "presence"})
    assert len(stream.getvalue().splitlines()) == NEWS_AT_ONCE
    time[0] = PERIOD
    log.info("%s", "robot 200 is on the mesh", extra={"reason": "presence"})
    assert stream.getvalue().splitlines()[-1].endswith("robot 200 is on the mesh (5 more like it were left out)")


def test_news_take_no_room_of_warnings(logged):
    """Clocks that agree again, of ten robots, left out the warning that one is wrong."""
    stream = logged()
    for number in range(AT_ONCE):
        log.info("%s", f"the clock of robot {number} is right", extra={"reason": "clock"})
    log.warning("%s", "the clock of robot 7 is wrong", extra={"reason": "clock"})
    assert stream.getvalue().splitlines()[-1].endswith("the clock of robot 7 is wrong")


def test_reasons_without_end_take_no_memory_without_end(logged):
    """The oldest is forgotten, and begins anew."""
    stream = logged()
    for number in range(2 * REASONS):
        log.warning("%s", f"text {number}")
    (limit,) = logging.getLogger().handlers[0].filters
    assert len(limit._spells) == REASONS
    assert len(stream.getvalue().splitlines()) == 2 * REASONS
