"""The memory benchmark tells what is held and what is left behind."""

import planner
from studies.benchmarks.memory import measure_memory, resident
from studies.benchmarks.speed import Team


def test_both_tables_are_measured():
    """Every search names its iterations, nodes and memory; decisions leave next to nothing behind."""
    searches, growth = measure_memory(quick=True)
    assert [row[0] for row in searches.rows] == ["best", "paper", "paper, reduction paper", "paper, reduction exact"]
    assert all(float(row[3]) <= 8.0 for row in searches.rows)
    assert all(float(row[2]) <= 1.0 for row in growth.rows)


def test_a_search_that_is_held_is_seen():
    """What is in use grows with the searches that are kept."""
    window, before, kept = Team(10, 60).windows(1)[0], resident(), []
    for _ in range(20):
        kept.append(planner.start(window, planner.SearchSettings(search="paper")))
        kept[-1].run(10_000)
    assert resident() - before > 5_000_000
