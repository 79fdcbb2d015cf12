"""The grid with more iterations."""


def test_every_budget_has_its_table(measured):
    """From the least to the greatest."""
    titles = [table.title for table in measured("iterations")]
    assert titles == [f"best mode, {budget} iterations" for budget in ("300", "1,500", "10,000")]
