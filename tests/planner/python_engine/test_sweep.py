"""The sweep down a window: what it keeps, and what it proves."""

import math

import pytest

from planner import SearchSettings
from planner.python_engine.best import BestSearch
from planner.python_engine.path import Path
from planner.python_engine.prices import Prices
from planner.python_engine.sweep import Sweep
from planner.tables import tabulate
from tests.planner.windows import optimum, window
from tests.seeds import seeds


def swept(problem, *, width, worth_trying=lambda _: True):
    """A sweep at its end, with learned prices."""
    tables = tabulate(problem)
    path = Path(tables)
    prices = Prices(tables, path)
    while prices.learning:
        prices.learn(prices.relax(), 0.0)
    sweep = Sweep(tables, path, prices, width)
    while not sweep.done:
        sweep.descend(worth_trying)
    return sweep


@pytest.mark.parametrize("seed", seeds(20))
def test_wide_sweep_finds_the_optimum(seed):
    """Where no level is cut, its best place is the best of all subsets."""
    problem = window(seed, robots=3, horizon=8, constraints=1 + seed % 2)
    sweep = swept(problem, width=10_000)
    assert sweep.whole
    assert max(place.value for place in sweep.places) == pytest.approx(optimum(problem)[0])


def test_narrow_sweep_claims_nothing():
    """What was left out may be better, so it is not whole; its plans are plans nevertheless."""
    narrow = 0
    for seed in range(20):
        problem = window(seed, robots=3, horizon=10, constraints=1)
        sweep = swept(problem, width=1)
        narrow += not sweep.whole
        (place,) = sweep.places
        assert place.value <= optimum(problem)[0] + 1e-9
    assert narrow > 10


def test_nothing_worth_trying_ends_it():
    """Without any place left it is done at once, and nothing was left out that might be better."""
    sweep = swept(window(1), width=10, worth_trying=lambda _: False)
    assert sweep.done
    assert sweep.whole
    assert sweep.places == []


def test_places_stand_by_rising_bound():
    """The best ones are extended, none has a bound below its value."""
    tables = tabulate(window(4, robots=5, horizon=20))
    path = Path(tables)
    prices = Prices(tables, path)
    while prices.learning:
        prices.learn(prices.relax(), 0.0)
    sweep = Sweep(tables, path, prices, 4)
    for _ in range(12):
        sweep.descend(lambda _: True)
        bounds = [place.bound for place in sweep.places]
        assert len(bounds) <= 4
        assert bounds == sorted(bounds)
        assert all(place.value <= place.bound + 1e-9 for place in sweep.places)


def test_best_mode_is_done_when_a_whole_sweep_ends():
    """No tree is needed where the sweep left nothing out."""
    proven = 0
    for seed in range(30):
        search = BestSearch(tabulate(window(seed, robots=4, horizon=12, constraints=1)), SearchSettings())
        while not search.done and not search.tree():
            search.run(1)
        if search.done and search.iterations > 12:
            proven += 1
            assert search.plan().gap == 0.0
            assert math.isfinite(search.plan().utility)
    assert proven > 3
