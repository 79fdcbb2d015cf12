"""The command of the simulation."""

from studies.simulation.__main__ import main


def test_every_flight_prints_a_line(capsys):
    """With what it reached, used and foresaw, and how wrong clocks change it."""
    options = "--workload most --seconds 3 --robots 3 --limit 2 --iterations 50 --seeds 2 --skew 10 --jitter 0.01"
    assert (
        main([*options.split(), "--coordination", "announce", "--transport", "broadcast", "--digests-by-unicast"]) == 0
    )
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 2
    for line in lines:
        assert all(word in line for word in ("of central", "of bound", "exceeding", "told", "same with clocks off"))
    assert main(["--workload", "few", "--sizes", "mixed", "--seconds", "2", "--iterations", "50"]) == 0
    assert "few" in capsys.readouterr().out
