"""The windows of which the speed benchmark times the tables."""

from planner import Aggregation
from planner.native_tables import NativeTables
from planner.tables import tabulate
from studies.benchmarks.tables import UTILITIES, of_all_kinds


def test_windows_hold_all_kinds():
    """Streams of every aggregation and utility stand side by side, and are tabulated in C++."""
    window = of_all_kinds(1, 20, 4, tuple(Aggregation))
    assert {stream.aggregation for stream in window.streams} == set(Aggregation)
    assert {type(m.utility) for m in window.messages} == set(map(type, UTILITIES))
    assert sum(not m.sent for m in window.messages) == 80
    assert isinstance(tabulate(window, beyond=True), NativeTables)
