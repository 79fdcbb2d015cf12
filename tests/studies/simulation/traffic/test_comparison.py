"""The comparison."""

import pytest

from studies.simulation.traffic.comparison import (
    LATENCIES,
    LOSSES,
    PLAN,
    Cell,
    Task,
    expected,
    fly_all,
    grid,
    how_of,
    tasks,
)

CELL = Cell("random", 2, 0.02, 0.0, 0, 2.0)


def test_two_workloads_are_flown_in_all_ways_and_the_others_in_some():
    """Latency and loss in all combinations, or one of them at a time."""
    cells = grid(3, 30.0)
    count = {(cell.workload, cell.robots): 0 for cell in cells}
    for cell in cells:
        count[cell.workload, cell.robots] += 1
    combined, varied = len(LATENCIES) * len(LOSSES), len(LATENCIES) + len(LOSSES) - 1
    assert count["mixed", 4] == count["random", 5] == 3 * combined
    assert count["cameras", 8] == count["uniform-few", 10] == 3 * varied
    assert count["crowd", 50] == varied
    assert len(set(cells)) == len(cells)


def test_what_loss_does_not_change_is_looked_for_once():
    """Bounds and plans; a central decider flies under each."""
    flights = tasks([CELL, Cell("random", 2, 0.02, 0.1, 0, 2.0)], ["bound", "central", PLAN])
    assert [task.contender for task in flights] == ["bound", "central", PLAN, "central"]
    assert expected(flights) > 0.0


def test_teams_are_written_with_their_settings():
    """Coordination, transport, and what else the core shall have."""
    how = how_of(CELL, "announce/broadcast/margin=0.1/horizon=90/mode=shadow")
    assert (how.coordination, how.transport, how.latency, how.loss) == ("announce", "broadcast", 0.02, 0.0)
    assert how.settings == (("margin", 0.1), ("horizon", 90), ("mode", "shadow"))
    for wrong in ("announce", "announce/smoke"):
        with pytest.raises(ValueError, match="announce"):
            how_of(CELL, wrong)


@pytest.mark.full
def test_all_contenders_fly_the_same_samples():
    """And are worth less than the bound."""
    names = ["bound", PLAN, "central", "greedy", "static", "greedy-parts", "announce/unicast"]
    results = {result.task.contender: result for result in fly_all(tasks([CELL], names), 1)}
    assert list(results) == names
    assert len({result.samples for result in results.values()}) == 1
    assert all(0.0 < result.utility <= results["bound"].utility * (1 + 1e-9) for result in results.values())
    assert "below the bound" in results[PLAN].note


@pytest.mark.full
def test_flights_in_several_processes_come_back_in_order():
    """With the same results."""
    flights = [Task(CELL, "greedy"), Task(CELL, "static")]
    one, two = (list(fly_all(flights, jobs)) for jobs in (1, 2))
    assert [(r.task, r.utility) for r in one] == [(r.task, r.utility) for r in two]
