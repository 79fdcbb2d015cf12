"""The command of the long runs, with short ones."""

import pytest

from studies.qualification.__main__ import LOGS, main
from studies.qualification.stages import STAGES, Stage

GOOD = Stage("good", "that it runs", ("sh", "-c", "echo first; echo == last $MUCH =="), {"MUCH": "7"})
BAD = Stage("bad", "that it fails", ("sh", "-c", "echo broken; exit 3"))


def test_all_stages_are_written_with_what_they_said(tmp_path, capsys):
    """One that fails fails the whole, does not keep others from running, and its log is named."""
    page = tmp_path / "page.md"
    assert main([], (BAD, GOOD), page) == 1
    text = page.read_text()
    assert [line.split() for line in text.splitlines() if line.startswith("| that")] == [
        ["|", "that", "it", "fails", "|", "no", "|", "0", "s", "|", "broken", "|"],
        ["|", "that", "it", "runs", "|", "yes", "|", "0", "s", "|", "last", "7", "|"],
    ]
    assert f"bad: failed, see {LOGS / 'bad.log'}" in capsys.readouterr().out


def test_a_part_is_run_without_a_page(tmp_path):
    """The page tells of whole runs only."""
    page = tmp_path / "page.md"
    assert main(["good"], (BAD, GOOD), page) == 0
    assert not page.exists()


def test_unknown_stages_are_refused(capsys):
    """The message names those that exist."""
    with pytest.raises(SystemExit):
        main(["gone"], (GOOD,))
    assert "'gone' is not one of good" in capsys.readouterr().err


def test_the_stages_find_what_they_name():
    """Their test files are there."""
    named = [word for stage in STAGES for word in stage.command if word.startswith("tests/")]
    assert named
    assert all((LOGS.parent.parent / word).exists() for word in named)
