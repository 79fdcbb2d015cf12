"""The speed benchmark measures what it says; how fast it is belongs to no test."""

from studies.benchmarks.speed import TEAMS


def test_all_tables_are_measured(measured):
    """Every search on both engines has a rate and decision times, p50 <= p99 <= max."""
    alone, chart, ratios, tables, decisions, longer = measured("speed")
    assert [row[0] for row in alone.rows] == ["paper, native", "best, native", "paper, python", "best, python"]
    assert all(float(row[1].split()[0].replace(",", "")) > 0 for row in alone.rows)
    assert [len(series.values) for series in chart.series] == [2] * 4
    assert ratios.rows[2][1] == ""
    assert float(ratios.rows[2][2]) > 0
    assert all(0 < float(row[2]) <= float(row[3]) for row in tables.rows)
    assert (len(decisions.rows), len(longer.rows)) == (4, 2)
    for row in (*decisions.rows, *longer.rows):
        p50, p99, longest = map(float, row[-3:])
        assert 0 < p50 <= p99 <= longest


def test_windows_come_from_the_middle_of_a_mission():
    """They hold facts and as many open messages as the horizon."""
    for window in TEAMS[0].windows(4):
        assert any(message.sent for message in window.messages)
        assert sum(not message.sent for message in window.messages) == 30
