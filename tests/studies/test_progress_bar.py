"""How far flights are, on standard error."""

import sys

import pytest

from studies import progress_bar
from studies.progress_bar import flights


def test_a_bar_counts_flights(capsys, monkeypatch):
    """Where the package rich is there."""
    pytest.importorskip("rich")
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    with flights(2, 10.0) as advance:
        advance(4.0)
        advance(6.0)
    assert "2 of 2 flights" in capsys.readouterr().err


def test_a_line_changes_without_the_package(capsys, monkeypatch):
    """After a while."""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    monkeypatch.setattr(progress_bar, "there", lambda _package: False)
    monkeypatch.setattr("studies.replay.progress.monotonic", iter(range(10)).__next__)
    with flights(4, 4.0) as advance:
        advance(1.0)
    assert "\r25 % of 4 flights are flown" in capsys.readouterr().err


def test_a_log_gets_a_line_now_and_then(capsys, monkeypatch):
    """Not a bar that nobody sees before its end."""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: False, raising=False)
    monkeypatch.setattr("studies.replay.progress.monotonic", iter(range(0, 100, 6)).__next__)
    with flights(4, 4.0) as advance:
        for _ in range(4):
            advance(1.0)
    assert capsys.readouterr().err == "50 % of 4 flights are flown\n100 % of 4 flights are flown\n"
