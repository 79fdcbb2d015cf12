"""The command of the long runs, with short ones."""

import re
import subprocess

import pytest

from studies.qualification import __main__ as command
from studies.qualification.__main__ import ROOT, main
from studies.qualification.stages import STAGES, Stage

GOOD = Stage("good", "that it runs", ("sh", "-c", "echo first; echo == last $MUCH =="), {"MUCH": "7"})
BAD = Stage("bad", "that it fails", ("sh", "-c", "echo broken; exit 3"))


def rows(page):
    """What the page says of each stage, but for dates and versions."""
    cells = [[cell.strip() for cell in line.split("|")[1:-1]] for line in page.read_text().splitlines()]
    return [[row[0], row[1], row[5]] for row in cells if row and row[0].startswith("that")]


def test_all_stages_are_written_with_what_they_said(tmp_path, capsys):
    """One that fails fails the whole, does not keep others from running, and its log is named."""
    page = tmp_path / "page.md"
    assert main([], (BAD, GOOD), page, tmp_path) == 1
    assert rows(page) == [["that it fails", "no", "broken"], ["that it runs", "yes", "last 7"]]
    assert re.search(r"\| +yes \| 20\d\d-\d\d-\d\d \d\d:\d\d \|", page.read_text())
    assert f"bad: failed, see {tmp_path / 'bad.log'}" in capsys.readouterr().out


def test_what_was_run_before_stays_on_the_page(tmp_path):
    """And what never was is said."""
    page = tmp_path / "page.md"
    assert main(["good"], (BAD, GOOD), page, tmp_path) == 0
    assert rows(page) == [["that it fails", "not run", ""], ["that it runs", "yes", "last 7"]]
    assert main(["bad"], (BAD, GOOD), page, tmp_path) == 1
    assert rows(page) == [["that it fails", "no", "broken"], ["that it runs", "yes", "last 7"]]


@pytest.mark.parametrize(
    ("line", "short"),
    [
        ("1 passed in 3.5 s (0:00:03)", "1 passed in 3.5 s (0:00:03)"),
        ("Medians. Of all.", "Medians"),
        ("x" * 300, "x" * 99 + "…"),
    ],
)
def test_the_page_has_a_short_sentence_of_each_stage(tmp_path, line, short):
    """However much it said."""
    page = tmp_path / "page.md"
    main([], (Stage("long", "that it is cut", ("echo", line)),), page, tmp_path)
    assert rows(page) == [["that it is cut", "yes", short]]


def test_the_page_is_written_of_what_ran_before(tmp_path):
    """Nothing runs, and it says what it is told to."""
    page = tmp_path / "page.md"
    main(["good"], (BAD, GOOD), page, tmp_path)
    assert main(["--page", "--note", "Much else ran."], (BAD, GOOD), page, tmp_path) == 0
    assert rows(page) == [["that it fails", "not run", ""], ["that it runs", "yes", "last 7"]]
    assert page.read_text().endswith("\n\nMuch else ran.\n")


def test_unknown_stages_are_refused(capsys):
    """The message names those that exist."""
    with pytest.raises(SystemExit):
        main(["gone"], (GOOD,))
    assert "'gone' is not one of good" in capsys.readouterr().err


def test_the_stages_find_what_they_name():
    """Their test files are there."""
    named = [word for stage in STAGES for word in stage.command if word.startswith("tests/")]
    assert named
    assert all((ROOT / word).exists() for word in named)


def test_pages_that_stages_write_make_no_other_version(tmp_path, monkeypatch):
    """Only what else was changed since the commit does."""

    def git(*words):
        who = ("-c", "user.name=a", "-c", "user.email=a@b")
        subprocess.run(["git", *who, *words], cwd=tmp_path, check=True, capture_output=True)

    page = tmp_path / "results" / "page.md"
    page.parent.mkdir()
    for file in (page, tmp_path / "code.py"):
        file.write_text("before")
    git("init", "--quiet")
    git("add", ".")
    git("commit", "--quiet", "--message", "all")
    monkeypatch.setattr(command, "ROOT", tmp_path)
    monkeypatch.setattr(command, "PAGE", page)
    page.write_text("after")
    assert not command._version().endswith("+")
    (tmp_path / "code.py").write_text("after")
    assert command._version().endswith("+")
