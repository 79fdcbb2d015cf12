"""The command that runs the benchmarks."""

import sys

import pytest

from studies.benchmarks.__main__ import BENCHMARKS, main

OF_DAEMONS = ("bridge", "budget", "watching", "daemons")
"""Each has a test of its own, which takes most of a minute."""


def test_quick_run_prints_and_writes_all_pages(tmp_path, capsys, monkeypatch, measured):
    """It leaves a page for each benchmark where it is told; those of real daemons run elsewhere."""
    for name in OF_DAEMONS:
        monkeypatch.delitem(BENCHMARKS, name)
    for name, (title, _) in list(BENCHMARKS.items()):
        monkeypatch.setitem(BENCHMARKS, name, (title, lambda quick, name=name: measured(name) if quick else ()))
    assert main(["--quick", "--output", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    assert "Utility lost against the integer optimum" in printed
    assert "Search alone" in printed
    assert sorted(page.stem for page in tmp_path.glob("*.md")) == sorted(BENCHMARKS)
    assert "| best, 300 iterations, horizon 60" in (tmp_path / "quality.md").read_text()


def test_quality_without_scipy_is_left_out(monkeypatch, capsys):
    """Without SciPy the other benchmarks run, and the exit says that one did not."""
    monkeypatch.setitem(sys.modules, "scipy.sparse", None)
    assert main(["--quick", "quality"]) == 1
    assert "sendworthy[study]" in capsys.readouterr().err


def test_unknown_benchmarks_are_refused(capsys):
    """The message names those that exist."""
    with pytest.raises(SystemExit):
        main(["speeed"])
    assert f"'speeed' is not one of {', '.join(BENCHMARKS)}" in capsys.readouterr().err
