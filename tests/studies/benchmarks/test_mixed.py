"""The mixed grid."""

from studies.mixed_workload import BYTE_LIMITS


def test_every_contender_has_a_row_for_each_byte_limit(measured):
    """Best mode comes first, the paper's search last; then what whole messages can reach."""
    results = measured("mixed")
    charts, tables = results[:3], results[3:]
    assert all(len(chart.places) == len(BYTE_LIMITS) for chart in charts)
    assert [table.title.split(" mode")[0] for table in tables[:4]] == ["best", "best", "best", "paper"]
    assert all(len(table.rows) == len(BYTE_LIMITS) for table in tables)
    for cell in (cell for row in tables[4].rows for cell in row[1:]):
        assert 0 < float(cell.lstrip("~").split()[0]) <= 100.0
