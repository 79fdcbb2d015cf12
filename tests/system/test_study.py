"""The study as `make study QUICK=1` flies it: in two processes, and so on all cores."""

import pytest

from studies.study.__main__ import main

pytestmark = pytest.mark.system


def test_the_quick_study_flies_and_goes_on(tmp_path, capsys):
    """Over ns-3, in two processes; the second time everything is known."""
    paths = ["--store", str(tmp_path / "records.jsonl"), "--page", str(tmp_path / "RESULTS.md")]
    assert main(["--extent", "quick", "--jobs", "2", *paths]) == 0
    assert "not flown yet" not in (tmp_path / "RESULTS.md").read_text()
    capsys.readouterr()
    assert main(["--extent", "quick", "--jobs", "2", *paths]) == 0
    assert "nothing to do" in capsys.readouterr().out
