"""The benchmark of how long decisions take."""

import pytest

from studies.benchmarks.deciding import RATE, SIZE, cases, many


@pytest.mark.full
def test_decisions_of_real_daemons_are_counted_and_told_in_milliseconds(measured):
    """A row for each case; some samples need a search, and most of these end in time."""
    (table,) = measured("deciding")
    assert [row[0] for row in table.rows] == [case.title for case in cases(quick=True)]
    for _, offered, searched, median, worst, deadline, over, twice in table.rows:
        assert float(offered) > 5.0
        assert int(searched) > 0
        assert 0.0 < float(median) <= float(worst)
        assert float(deadline) in {5.0, 20.0}
        assert 0.0 <= float(twice.rstrip("%")) <= float(over.rstrip("%")) <= 100.0


def test_a_quarter_of_what_many_streams_send_fits():
    """They are alike, and each is one of its own."""
    workload = many(20, 1.5)
    assert workload.rate == pytest.approx(0.25 * 20 * 1.5 * SIZE)
    assert len(workload.kinds) == 20


def test_a_short_look_takes_less():
    """The whole one has a busy process beside each of the robots with many streams."""
    whole = cases(quick=False)
    assert [case.busy for case in whole] == [0, 1, 0, 0, 1]
    assert {len(case.workload.kinds) for case in whole[1:]} == {100}
    assert {case.workload.rate for case in whole[1:]} == {0.25 * SIZE * RATE, 0.25 * 100 * SIZE * RATE}
    assert len(cases(quick=True)) == 2
