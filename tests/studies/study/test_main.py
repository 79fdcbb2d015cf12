"""The command that flies the study."""

import pytest

from studies.study.__main__ import main
from studies.study.programme import QUICK
from tests.studies.study.records import filled


@pytest.fixture
def flown(tmp_path):
    """Arguments for a study of which everything is known."""
    filled(tmp_path / "records.jsonl", QUICK, lambda _: {})
    paths = ["--store", str(tmp_path / "records.jsonl"), "--page", str(tmp_path / "page" / "RESULTS.md")]
    return ["--extent", "quick", "--jobs", "1", *paths]


def test_the_plan_alone_is_printed(tmp_path, capsys):
    """With its expected time."""
    assert main(["--plan", "--store", str(tmp_path / "none.jsonl")]) == 0
    assert "expected: " in capsys.readouterr().out
    assert not list(tmp_path.iterdir())


@pytest.mark.full
def test_a_study_that_is_over_only_writes_its_page(flown, tmp_path, capsys):
    """It flies nothing twice."""
    assert main(flown) == 0
    shown = capsys.readouterr().out
    assert "nothing to do" in shown
    assert "flown 0 in 0 s" in shown
    assert (tmp_path / "page" / "RESULTS.md").exists()


def test_without_its_extra_nothing_is_flown(flown, capsys, monkeypatch):
    """It is said at the beginning, not after hours."""
    monkeypatch.setattr("studies.study.__main__.there", lambda package: package != "matplotlib")
    assert main(flown) == 1
    assert 'needs the extra "study": pip install "sendworthy[study]"' in capsys.readouterr().err
