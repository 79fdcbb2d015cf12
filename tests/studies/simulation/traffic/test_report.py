"""Lines and tables of the comparison."""

from dataclasses import replace

from studies.simulation.traffic.comparison import Cell, Result, Task
from studies.simulation.traffic.marks import Marks
from studies.simulation.traffic.report import line, tables
from tests.studies.simulation.traffic.flown import SCORE

CELL = Cell("mixed", 2, 0.02, 0.01, 0, 30.0)


def results():
    team, central = (
        Result(Task(CELL, name), u, 9e5, 1000, 2.0, SCORE) for name, u in (("x/unicast", 80.0), ("central", 90.0))
    )
    return [Result(Task(CELL, "bound"), 100.0, 9.5e5, 1000, 1.0, note="a note"), central, team]


def test_a_line_has_every_figure():
    """Beside the central decider and the bound, as far as these are known."""
    marks = Marks(results())
    text = line(results()[2], marks)
    for figure in ("mixed:2 20 ms 1 % seed 0 x/unicast", "of central 88.9 %, of bound 80.0 %", "fill 90.0 %"):
        assert figure in text
    for figure in ("over 1.0 %, worst 1.20", "alarms 6/7", "age 20 / 30 ms", "silent 1.5 s", "2.00 ms a sample"):
        assert figure in text
    assert "of central –" in line(results()[2], Marks())
    assert line(results()[0], marks).endswith("a note")


def test_a_table_has_a_column_for_each_contender():
    """With the means over seeds, the fullest window of all, and the sum of alarms."""
    worse = replace(SCORE, worst=1.5, arrived=1.0)
    other = [
        Result(Task(replace(CELL, seed=1), name), u, 9e5, 1000, 2.0, worse)
        for name, u in (("x/unicast", 85.0), ("central", 90.0))
    ]
    _, worth, use, small = tables([*results(), *other])
    assert worth.columns == ("latency, loss", "bound", "central", "x/unicast")
    (row,) = worth.rows
    assert row[0] == "20 ms 1 %"
    assert row[1] == "111.1 (100.0)"
    assert row[3].startswith("91.7 ± ")
    assert row[3].endswith(" / 1.0, 1.50")
    assert use.rows[0][1:] == ("950 kB", "90.0 / 12 / 1.5 / 2.00", "90.0 / 12 / 1.5 / 2.00")
    assert small.rows[0][3] == "100.0 / 99.0 (99.0) / 20, 30 / 12 of 14"


def test_a_workload_without_small_samples_has_no_table_of_them():
    """Nor an interval with one seed, nor a cell where nobody flew."""
    plain = [replace(result, score=result.score and replace(result.score, has_small=False)) for result in results()]
    late = Result(Task(replace(CELL, latency=1.0), "central"), 50.0, 9e5, 1000, 2.0, plain[1].score)
    _, worth, _ = tables([*plain, late])
    assert worth.rows[1][1:] == ("", "100.0 (–) / 1.0, 1.20", "")
