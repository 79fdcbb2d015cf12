"""The reduction for Markovian types: statistics stay consistent while subtrees move."""

import pytest

from planner import SearchSettings
from planner.constraints import violations
from planner.python_engine.paper import PaperSearch
from planner.python_engine.tree import CUT
from planner.tables import tabulate
from tests.planner.windows import stale_window, window
from tests.seeds import seeds


def grown(seed, reduction, iterations, problem=None):
    problem = problem or window(seed, robots=1 + seed % 3, horizon=9, constraints=1, grid=seed % 2 == 0)
    search = PaperSearch(tabulate(problem), SearchSettings(search="paper", reduction=reduction))
    search.run(iterations)
    return problem, search


def sends_of(problem, rows, index):
    opened = [at for at, message in enumerate(problem.messages) if not message.sent]
    sends = []
    while index > 0:
        parent, level, decision, *_ = rows[index]
        if decision:
            sends.append(opened[level - 1])
        index = parent
    return sends


@pytest.mark.parametrize("reduction", ["off", "paper", "exact"])
@pytest.mark.parametrize("seed", seeds(100))
def test_tree_stays_consistent(seed, reduction):
    """Every living node fits, knows the utility of its path, and has the visits of its children and its own."""
    drawn = stale_window(seed) if seed >= 12 else None
    problem, search = grown(seed, reduction, 200, drawn)
    rows = search.tree()
    tables = tabulate(problem)
    below = [0] * len(rows)
    scores = [0.0] * len(rows)
    for parent, *_, visits, total, _ in rows:
        if parent >= 0:
            below[parent] += visits
            scores[parent] += total
    for index, (parent, level, _, visits, total, worth) in enumerate(rows):
        if parent == CUT:
            continue
        sends = sends_of(problem, rows, index)
        assert violations(problem, sends) == []
        assert worth == pytest.approx(tables.gains.facts + gained(problem, tables, sends), abs=1e-9)
        own = visits - below[index]
        assert own >= 0
        assert total == pytest.approx(scores[index] + own * worth / tables.scale[level], rel=1e-6, abs=1e-6)


def gained(problem, tables, sends):
    state = [0] * len(problem.streams)
    total = 0.0
    for level, message in enumerate(tables.message):
        if message in sends:
            stream = tables.gains.stream[level]
            total += tables.gains.gain[tables.gains.start[level] + state[stream]]
            state[stream] = tables.gains.after[tables.gains.start[level] + state[stream]]
    return total


def test_reduced_tree_is_smaller():
    """The same number of iterations looks at more of the future when tantamount nodes are merged."""
    deepest = {}
    for reduction in ("off", "paper"):
        reached = []
        for seed in range(0, 12, 3):
            rows = grown(seed, reduction, 300)[1].tree()
            reached.append(sum(row[0] != CUT for row in rows))
        deepest[reduction] = sum(reached)
    assert deepest["paper"] < deepest["off"]
