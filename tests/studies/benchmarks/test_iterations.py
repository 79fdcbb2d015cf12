"""The grid with more iterations."""

from studies.benchmarks.iterations import measure_iterations


def test_every_budget_has_its_table():
    """From the least to the greatest."""
    titles = [table.title for table in measure_iterations(quick=True)]
    assert titles == [f"best mode, {budget} iterations" for budget in ("300", "1,500", "10,000")]
