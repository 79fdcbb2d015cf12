"""What the study flies."""

import pytest

from studies.study.contenders import BOUND, CONTENDERS
from studies.study.costs import expected, plan
from studies.study.programme import EXTENTS, FULL, QUICK, SWEEPS, bound_of, everything, main_tasks, sweeps

MOST_HOURS = 4.0
CORES = 2


def test_the_full_study_is_that_of_the_paper():
    """Three scenarios, 30 limits, 30 probabilities, 100 s."""
    assert len(set(FULL.limits)) == len(set(FULL.probabilities)) == 30
    assert FULL.probabilities[-1] <= 1.0
    assert FULL.seconds == 100.0
    assert FULL.seeds > 1
    assert {task.scenario for task in main_tasks(FULL)} == {"few", "mixed", "most"}


def test_the_full_study_takes_four_hours_at_most():
    """On two cores."""
    assert sum(map(expected, everything(FULL))) / CORES < MOST_HOURS * 3600


def test_the_quick_study_takes_less_than_a_minute():
    """On two cores, ns-3 included."""
    assert sum(map(expected, everything(QUICK))) / CORES < 60.0


@pytest.mark.parametrize("extent", EXTENTS.values(), ids=lambda extent: extent.name)
def test_everything_is_flown_once_and_has_its_bound(extent):
    """But for those who know no limit, and for what is a part of the maximum."""
    tasks = everything(extent)
    keys = {task.key for task in tasks}
    assert len(keys) == len(tasks)
    others = {task.key for sweep in sweeps(extent) if sweep.of == "maximum" for _, _, task in sweep.tasks(extent)}
    for task in tasks:
        if task.contender != BOUND and not (task.contender in CONTENDERS and CONTENDERS[task.contender].random):
            assert bound_of(task).key in keys or task.key in others


def test_each_point_of_a_sweep_is_a_task_of_its_own():
    """Lines do not fall together, points neither."""
    for sweep in SWEEPS:
        keys = [task.key for _, _, task in sweep.tasks(FULL)]
        assert len(keys) == len(set(keys)) == len(sweep.lines) * len(sweep.points) * FULL.sweep_seeds


def test_the_plan_says_how_long_it_takes():
    """Before anything is flown."""
    said = plan(everything(FULL), 3, 2)
    assert "3 are known already" in said
    assert " h of one core" in said
    assert "nothing to do" in plan([], 5, 2)
