"""What all aggregations have in common: their tables add up to the utility by the definition."""

import random
from dataclasses import replace

import pytest

from planner import Aggregation, SearchSettings, start
from planner.definition import utility
from planner.tables import tabulate
from tests.planner.models import Coverage, Newest
from tests.planner.windows import objective, objectives, open_messages, optimum, window
from tests.seeds import seeds

EXACT = (
    Aggregation.MOST_RECENT,
    Aggregation.SUM,
    Aggregation.ONCE,
    Aggregation.CURRENT,
    Newest(),
    Coverage(),
)
DISCRETE = 2e-3
"""What cutting time into cells may cost, as a part of the utility."""


def name(aggregation):
    return str(aggregation) if isinstance(aggregation, Aggregation) else type(aggregation).__name__


def added_up(problem, sends, tables):
    """U and what the search maximises, as a search adds them up."""
    gains = tables.gains
    state, total, aim = [0] * tables.streams, gains.facts, gains.aim_facts
    for level, index in enumerate(open_messages(problem)):
        if index in sends:
            entry = gains.start[level] + state[gains.stream[level]]
            assert entry < gains.start[level + 1]
            total, aim = total + gains.gain[entry], aim + gains.aim[entry]
            state[gains.stream[level]] = gains.after[entry]
    return total, aim


def plans(problem, seed):
    """Some sets of messages to send, none and all among them."""
    draw, opened = random.Random(seed), open_messages(problem)
    return [[], opened, *([i for i in opened if draw.random() < part] for part in (0.2, 0.5, 0.8))]


@pytest.mark.parametrize("aggregation", EXACT, ids=name)
@pytest.mark.parametrize("block", seeds(4, 1))
def test_gains_add_up_to_the_utility(aggregation, block):
    """Whatever was sent before, comes in between or is received later, for one receiver or several."""
    for seed in range(10 * block, 10 * block + 10):
        problem = window(seed, robots=1 + seed % 4, horizon=6, grid=seed % 3 == 0, aggregations=(aggregation,) * 2)
        for beyond in (False, True):
            tables = tabulate(problem, beyond=beyond)
            for sends in plans(problem, seed):
                total, _ = added_up(problem, sends, tables)
                assert total == pytest.approx(utility(problem, sends), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("seed", seeds(30))
def test_gains_of_best_add_up_but_for_the_cells(seed):
    """Their sum misses the integral of the envelope by what crosses within a cell."""
    problem = window(seed, robots=1 + seed % 4, horizon=8, grid=seed % 3 == 0, aggregations=(Aggregation.BEST,) * 2)
    for beyond in (False, True):
        tables = tabulate(problem, beyond=beyond)
        for sends in plans(problem, seed):
            total, _ = added_up(problem, sends, tables)
            assert total == pytest.approx(utility(problem, sends), rel=DISCRETE, abs=1e-4)


@pytest.mark.parametrize("seed", seeds(40))
def test_mixed_aggregations_add_up(seed):
    """Streams of all aggregations stand in one table."""
    kinds = (*Aggregation, Newest())
    problem = window(seed, robots=2 + seed % 4, horizon=9, grid=seed % 2 == 0, aggregations=kinds)
    tables = tabulate(problem)
    for sends in plans(problem, seed):
        total, _ = added_up(problem, sends, tables)
        assert total == pytest.approx(utility(problem, sends), rel=DISCRETE, abs=1e-4)


@pytest.mark.parametrize("seed", seeds(30))
def test_everything_is_the_utility_of_all_messages(seed):
    """U(M) of Eq. 2, whatever the aggregation; of `current` nothing is taken off, so that scores have a scale."""
    problem = window(seed, robots=2 + seed % 4, horizon=9, aggregations=(*Aggregation, Newest()))
    unspoilt = replace(
        problem,
        streams=tuple(
            s._replace(aggregation=Aggregation.MOST_RECENT) if s.aggregation is Aggregation.CURRENT else s
            for s in problem.streams
        ),
    )
    tables = tabulate(problem)
    assert tables.gains.everything == pytest.approx(utility(unspoilt, open_messages(problem)), rel=DISCRETE, abs=1e-4)
    assert tables.gains.facts == pytest.approx(utility(problem, []), rel=DISCRETE, abs=1e-4)


@pytest.mark.parametrize("engine", ["native", "python"])
@pytest.mark.parametrize("aggregation", EXACT[1:], ids=name)
def test_best_mode_finds_the_optimum(engine, aggregation):
    """Whatever the aggregation, the search proves and returns the best of all subsets."""
    for seed in range(12):
        problem = window(
            seed, robots=2, horizon=7, constraints=seed % 3, goes_on=False, aggregations=(aggregation,) * 2
        )
        search = start(problem, SearchSettings(engine=engine))
        search.run(5000)
        assert search.done
        assert search.plan().utility == pytest.approx(optimum(problem)[0], rel=1e-8, abs=1e-9)


@pytest.mark.parametrize("seed", seeds(40))
def test_gains_add_up_to_the_objective(seed):
    """What streams leave behind at the end of the window counts, each as its aggregation has it."""
    kinds = (Aggregation.SUM, Aggregation.CURRENT, Aggregation.ONCE, Aggregation.MOST_RECENT, Newest())
    problem = window(seed, robots=4, horizon=9, constraints=seed % 3, aggregations=kinds)
    tables = tabulate(problem, beyond=True)
    for sends in plans(problem, seed):
        _, aim = added_up(problem, sends, tables)
        assert aim == pytest.approx(objective(problem, sends), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("engine", ["native", "python"])
@pytest.mark.parametrize("seed", seeds(12))
def test_best_mode_finds_the_optimum_of_its_objective(seed, engine):
    """Also where the mission goes on, whatever the aggregations."""
    kinds = (Aggregation.SUM, Aggregation.CURRENT, Aggregation.ONCE, Aggregation.MOST_RECENT, Newest())
    problem = window(seed, robots=3, horizon=7, constraints=1 + seed % 2, aggregations=kinds)
    search = start(problem, SearchSettings(engine=engine))
    search.run(5000)
    assert search.done
    best = optimum(problem, objectives)[0]
    assert objective(problem, search.plan().sends) == pytest.approx(best, rel=1e-8, abs=1e-9)
