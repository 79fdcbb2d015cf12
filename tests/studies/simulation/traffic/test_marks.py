"""What flights are compared with."""

from dataclasses import replace

import pytest

from studies.simulation.traffic.comparison import Cell, Result, Task
from studies.simulation.traffic.marks import Marks

CELL = Cell("random", 5, 0.02, 0.01, 0, 30.0)


def flown(name, utility, **where):
    return Result(Task(replace(CELL, **where), name), utility, 0.0, 1, 0.0)


def test_the_bound_is_that_of_any_loss_and_the_decider_that_of_the_cell():
    """What nobody flew is compared with nothing."""
    marks = Marks([flown("bound", 100.0), flown("central", 80.0)])
    assert (marks.of_central(flown("x", 40.0)), marks.of_bound(flown("x", 40.0))) == (0.5, pytest.approx(0.4))
    assert (marks.of_central(flown("x", 40.0, loss=0.1)), marks.of_bound(flown("x", 40.0, loss=0.1))) == (None, 0.4)
    assert marks.of_bound(flown("x", 40.0, seed=1)) is None
    assert marks.large(flown("x", 40.0)) is None
