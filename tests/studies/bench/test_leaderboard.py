"""Scores as tables and as a page."""

from dataclasses import replace
from datetime import UTC, datetime

from studies.bench.flying import Score
from studies.bench.leaderboard import by_mission, ranked, summary, text, write_page
from tests.studies.bench.small import write

SCORES = [
    Score("one", "greedy", 0.8, 0.5, 0.5, 0.0, (0.001, 0.002)),
    Score("one", "best", 0.9, 0.4, 0.0, 500.0, (0.002, 0.004)),
    Score("two", "greedy", 0.6, 0.3, 0.0, 0.0, (0.001, 0.002)),
    Score("two", "best", 0.8, 0.2, 0.0, 300.0, (0.002, 0.004)),
]


def test_policies_are_ranked_by_their_mean_score():
    """What exceeded limits is counted."""
    assert ranked(SCORES) == ["best", "greedy"]
    assert summary(SCORES).rows == (
        ("best", "85.0", "85.0", "30.0", "0.0", "2.00", "4.00", "400"),
        ("greedy", "50.0", "70.0", "40.0", "25.0", "1.00", "2.00", "0"),
    )


def test_each_mission_has_the_score_of_each_policy():
    """And the utility where that is another one."""
    assert by_mission(SCORES).rows == (("one", "90.0", "40.0 (80.0)"), ("two", "80.0", "60.0"))
    assert "40.0 (80.0)" in text(SCORES)


def test_the_name_of_a_mission_cannot_command_the_terminal():
    """Its file may come from anybody."""
    shown = text([replace(SCORES[0], mission="one\x1b[2J")])
    assert "one\ufffd[2J" in shown
    assert "\x1b" not in shown


def test_the_page_says_what_was_flown_and_when(tmp_path):
    """With checksums and rules; folders are made."""
    page = tmp_path / "results" / "leaderboard.md"
    missions = [write(tmp_path / "one.jsonl")]
    write_page(page, SCORES, missions, datetime(2026, 1, 2, 3, 4, tzinfo=UTC))
    written = page.read_text()
    assert written.startswith("# Leaderboard\n\nWritten by `sendworthy bench` on 2026-01-02 03:04 UTC. ")
    assert "| best   |  85.0 |" in written
    assert "- `greedy`: whatever fits as far as known" in written
    (row,) = (line for line in written.splitlines() if line.startswith("| small "))
    assert [cell.strip() for cell in row.split("|")[2:8]] == ["2", "24", "12", "50", "0", "80"]
