"""The log: one line per event."""

import io
import logging
import re

import pytest

from proxy.log import set_up_logging


@pytest.fixture
def logged(monkeypatch):
    """Set up logging to a buffer; the root logger is put back afterwards."""
    root = logging.getLogger()
    monkeypatch.setattr(root, "level", root.level)
    monkeypatch.setattr(root, "handlers", [])

    def set_up(level, environ):
        stream = io.StringIO()
        set_up_logging(level, environ, stream)
        return stream

    return set_up


def test_a_line_has_time_level_and_room(logged):
    """On a terminal each line says when, how bad and where."""
    stream = logged("info", {})
    logging.getLogger("proxy.gate").warning("the limit is %d B", 5)
    assert re.fullmatch(
        r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d,\d{3} WARNING proxy\.gate: the limit is 5 B\n", stream.getvalue()
    )


def test_the_journal_stamps_lines_itself(logged):
    """Under systemd no time is printed twice."""
    stream = logged("info", {"JOURNAL_STREAM": "8:1234"})
    logging.getLogger("proxy.gate").info("hello")
    assert stream.getvalue() == "INFO proxy.gate: hello\n"


def test_less_than_the_level_is_not_logged(logged):
    """The level is the least that is logged."""
    stream = logged("warning", {})
    logging.getLogger("proxy.gate").info("hello")
    assert stream.getvalue() == ""


def test_a_traceback_stays_on_one_line(logged):
    """One event is one line, whatever it holds."""
    stream = logged("debug", {"JOURNAL_STREAM": "8:1"})
    try:
        int("first\nsecond")
    except ValueError:
        logging.getLogger("proxy").exception("it\nfailed")
    (line,) = stream.getvalue().splitlines()
    assert line.startswith("ERROR proxy: it | failed | Traceback")
    assert line.endswith("ValueError: invalid literal for int() with base 10: 'first\\nsecond'")
