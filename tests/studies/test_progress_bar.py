"""How far flights are, on standard error."""

import sys

import pytest

from studies import progress_bar
from studies.progress_bar import flights


def test_a_bar_counts_flights(capsys):
    """Where the package rich is there."""
    pytest.importorskip("rich")
    with flights(2, 10.0) as advance:
        advance(4.0)
        advance(6.0)
    assert "2 of 2 flights" in capsys.readouterr().err


def test_lines_say_it_without_a_bar(capsys, monkeypatch):
    """In a terminal the line changes."""
    monkeypatch.setattr(progress_bar, "there", lambda _package: False)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    monkeypatch.setattr("studies.replay.progress.monotonic", iter(range(10)).__next__)
    with flights(4, 4.0) as advance:
        advance(1.0)
    assert "25 % of 4 flights are flown" in capsys.readouterr().err
