"""How often costly features are computed."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from utility_specs.features import pace as module
from utility_specs.features.pace import Pace, Paces

BUDGET = 0.01


def computed(costs, samples):
    """Let samples come, each computation at once and with the next of the costs, the last for ever; return which."""
    pace, when, costs = Pace(0.0), [], list(costs)
    for number in range(samples):
        if not pace.costly(BUDGET) or pace.due(BUDGET):
            when.append(number)
            pace.took(costs.pop(0) if len(costs) > 1 else costs[0], float(number))
    return when, pace


def test_what_keeps_to_its_budget_is_computed_for_every_sample():
    """Up to the budget itself."""
    assert computed([BUDGET], 5)[0] == [0, 1, 2, 3, 4]


def test_what_takes_four_budgets_is_computed_for_every_fourth_sample():
    """The value of the last computation stays in between."""
    when, pace = computed([4 * BUDGET], 12)
    assert when == [0, 4, 8]
    assert (pace.value, pace.cost) == (8.0, 4 * BUDGET)


def test_one_outlier_is_forgotten():
    """As the smoothed cost comes down, every sample is computed again."""
    when, pace = computed([2 * BUDGET, 0.1 * BUDGET], 20)
    assert when[-10:] == list(range(10, 20))
    assert not pace.costly(BUDGET)


@given(st.lists(st.floats(1e-4, 0.5), min_size=1, max_size=8))
def test_on_average_nothing_takes_more_than_its_budget(costs):
    """A steady cost, once it is known."""
    for cost in costs:
        when, _ = computed([cost], 400)
        assert (len(when) - 1) * cost <= 400 * BUDGET * 1.0001 or cost <= BUDGET


def test_one_computation_at_a_time():
    """None begins while one is under way; one that was refused may begin with the next sample."""
    pace = Pace(0.5)
    pace.took(BUDGET, 1.0)
    assert pace.due(BUDGET)
    assert not pace.due(BUDGET)
    pace.refused()
    assert pace.due(BUDGET)
    pace.took(BUDGET, 2.0)
    assert pace.value == 2.0


def test_streams_and_features_have_their_own_paces():
    """What was not computed yet has its default."""
    paces = Paces()
    paces.of("red", "a", 0.1).took(3.0, 1.0)
    paces.of("red", "b", 0.1).took(5.0, 2.0)
    paces.of("blue", "a", 0.3)
    assert [paces.of(name, key, 0.1).value for name, key in (("red", "a"), ("red", "b"), ("blue", "a"))] == [1, 2, 0.3]
    assert paces.costs() == {"red": 5.0}


def test_what_holds_is_counted():
    """By feature."""
    paces = Paces()
    for name in ("red", "blue", "red"):
        paces.hold(name)
    assert paces.held() == {"red": 2, "blue": 1}


def test_streams_are_bounded(monkeypatch):
    """Those that were silent longest are forgotten, and counted."""
    monkeypatch.setattr(module, "STREAMS", 2)
    paces = Paces()
    for number, key in enumerate(("a", "b", "a", "c")):
        paces.of("red", key, 0.0).took(1.0, float(number))
    assert paces.evicted == 1
    assert paces.of("red", "a", 0.0).value == 2.0
    assert paces.of("red", "b", 0.0).value == pytest.approx(0.0)
