"""The command of the comparison."""

import pytest

from studies.simulation.traffic.__main__ import main


def test_it_says_how_long_it_takes_and_writes_a_table(tmp_path, capsys):
    """A line for each flight, of the workloads that are asked for."""
    page = tmp_path / "table.md"
    options = (
        "--workloads random:2 uniform-few --seconds 2 --seeds 1 --jobs 1 --yardsticks greedy --teams --only random"
    )
    assert main([*options.split(), "--output", str(page)]) == 0
    first, *lines = capsys.readouterr().out.splitlines()
    assert first.startswith("1 flights, about ")
    assert [each.split(" | ")[0] for each in lines] == ["random:2 20 ms 1 % seed 0 greedy"]
    assert "## random, 2 robots: utility and windows" in page.read_text()


def test_what_cannot_be_flown_is_refused_before_anything_flies(capsys):
    """A team without transport, and a workload that nobody knows."""
    with pytest.raises(ValueError, match="announce"):
        main(["--workloads", "random:2", "--teams", "announce", "--jobs", "1"])
    with pytest.raises(SystemExit):
        main(["--workloads", "none:2"])
    assert "uniform-few" in capsys.readouterr().err
