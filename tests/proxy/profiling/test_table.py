"""A profile as text."""

from proxy.profiling.table import table
from tests.proxy.profiling.profiles import profile


def test_the_table_tells_what_each_stage_took():
    """For a sample, of a core, of the daemon, and how sure that is."""
    lines = table(profile()).splitlines()
    assert lines[0] == "robot r1   2.0 s   30 samples decided, 15 passed, 5 delivered"
    rows = {line.split()[0]: line.split()[1:] for line in lines[3:-2]}
    assert rows["search"] == ["10.000", "25.00%", "50.0%", "5.0%"]
    assert rows["core"] == ["5.000", "12.50%", "25.0%", "4.3%"]
    assert rows["ingress"] == ["0.000", "0.00%", "0.0%", "0.0%"]
    assert rows["all"] == ["20.000", "50.00%", "100.0%", "0.0%"]
    assert lines[-1] == "100 looks, which took 0.50% of a core besides"


def test_where_nothing_crossed_nothing_is_said_of_samples():
    """An idle daemon takes time, too."""
    (row,) = [line.split() for line in table(profile(samples=(0, 0, 0))).splitlines() if line.startswith("core ")]
    assert row[1:3] == ["-", "12.50%"]
