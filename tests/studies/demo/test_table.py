"""The table at the end of the demo."""

from studies.demo.events import Counts, Publish, Receive, Run
from studies.demo.figures import figures
from studies.demo.table import table


def a_run(phase, delay):
    red = Publish(phase, "r1", 0, 10.0, 35_000, 0.25)
    other = Publish(phase, "r1", 1, 12.0, 35_000, 0.0)
    receipts = [Receive(phase, "r1", e.number, e.t + delay, e.t, e.size) for e in (red, other)]
    return [Run(phase, 10.0, 4.0, ("r1",), 3e6, 2.7e6, 1.0), red, other, *receipts]


def test_the_table_sets_all_runs_side_by_side():
    """Red and other frames of each run in a row of 80 columns; what is not known is a dash."""
    runs = [*a_run("without", 1.5), *a_run("downsampled", 0.5), *a_run("with", 0.25)]
    found = table(figures([*runs, Counts("with", "r1", 2, 2, 0, 0)])).splitlines()
    rows = {line[:38].strip(): line[38:].split() for line in found}
    assert max(map(len, found)) <= 80
    assert rows["age of a frame, 95 % [s]"] == ["1.50", "1.50", "0.50", "0.50", "0.25", "0.25"]
    assert rows["frames per second and robot"] == ["0.50"] * 6
    assert rows["every sample accounted for"] == ["–", "–", "yes"]
    assert rows["connections around the medium"] == ["0", "0", "0"]
