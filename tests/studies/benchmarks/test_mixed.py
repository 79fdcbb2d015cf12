"""The mixed grid."""

from studies.benchmarks.mixed import measure_mixed
from studies.mixed_workload import BYTE_LIMITS


def test_every_contender_has_a_row_for_each_byte_limit():
    """Best mode comes first, the paper's search last."""
    tables = measure_mixed(quick=True)
    assert [table.title.split(" mode")[0] for table in tables] == ["best", "best", "best", "paper"]
    assert all(len(table.rows) == len(BYTE_LIMITS) for table in tables)
