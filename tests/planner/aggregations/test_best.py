"""`best`: the upper envelope of what was received."""

import numpy as np
import pytest

from planner import Aggregation, Linear, Message, Problem, ProblemError, SearchSettings, Stream
from planner.aggregations import best
from planner.definition import utility
from planner.evaluation import tabulate_gains
from planner.native_engine import NativeSearch
from planner.numpy_tables import tabulate_with_numpy
from planner.python_engine.best import BestSearch


def stream(*messages, t_end=10.0):
    return Problem((Stream(0, Aggregation.BEST),), messages, 0, (), (), -1.0, t_end)


def message(t_gen, *, scale=1.0, slope=0.1):
    return Message(0, t_gen, t_gen, t_gen, Linear(1.0, slope), scale, ())


def test_older_message_counts_again_when_the_newer_faded():
    """A newer one of steep utility is best at first, then the older one is again."""
    both = stream(message(0.0, slope=0.05), message(1.0, scale=3.0, slope=1.0))
    older = (1.0 - 0.05 / 2) + sum_of(lambda t: max(1.0 - 0.05 * t, 3.0 * max(0.0, 1.0 - (t - 1.0))), 1.0, 10.0)
    assert utility(both, [0, 1]) == pytest.approx(older, rel=1e-5)


def sum_of(function, begin, end):
    times = np.linspace(begin, end, 200_001)
    middles = (times[1:] + times[:-1]) / 2
    return float(sum(map(function, middles.tolist())) * (end - begin) / 200_000)


def test_worse_message_adds_nothing():
    """What is never the best is worth nothing beside the better one, in any order."""
    gains = tabulate_gains(stream(message(0.0, scale=5.0, slope=0.001), message(1.0)))
    assert gains.gain.tolist()[2] == 0.0
    assert gains.gain.tolist()[1] > 0.0


def test_equal_envelopes_are_one_state():
    """When every newer message outshines all before it, a stream has one state for each."""
    gains = tabulate_gains(stream(*(message(0.1 * at) for at in range(20))))
    assert np.diff(gains.start).tolist() == list(range(1, 21))


def test_states_are_bounded(monkeypatch):
    """Beyond the bound a new envelope is taken for the nearest, and the gains stay close to the truth."""
    messages = [message(0.1 * at, scale=1.0 + 0.9**at, slope=0.5 + 0.09 * at) for at in range(9)]
    problem = stream(*messages, t_end=6.0)
    exact = tabulate_gains(problem)
    assert np.diff(exact.start).max() == 30
    monkeypatch.setattr(best, "MAX_STATES", 16)
    bounded = tabulate_gains(problem)
    assert np.diff(bounded.start).max() == 16
    for sends in ([0, 2, 4, 6, 8], [1, 3, 5, 7], list(range(9))):
        assert added(bounded, sends) == pytest.approx(utility(problem, sends), rel=0.05)


def test_nothing_is_proven_by_states_that_stand_for_others(monkeypatch):
    """The utility of the plan is the true one, and no gap is claimed."""
    messages = [message(0.1 * at, scale=1.0 + 0.9**at, slope=0.5 + 0.09 * at) for at in range(9)]
    problem = stream(*messages, t_end=6.0)
    monkeypatch.setattr(best, "MAX_STATES", 16)
    tables = tabulate_with_numpy(problem, beyond=True)
    for search in (NativeSearch(tables, SearchSettings()), BestSearch(tables, SearchSettings())):
        search.run(300)
        plan = search.plan()
        assert plan.gap is None
        assert plan.utility == utility(problem, plan.sends)


def test_too_many_messages_are_refused():
    """A window whose cells would not fit in memory is an error that says so."""
    with pytest.raises(ProblemError, match="too many for `best`"):
        tabulate_gains(stream(*(message(0.001 * at) for at in range(2_000))))


def added(gains, sends):
    state, total = 0, gains.facts
    for level in sends:
        entry = gains.start[level] + state
        total, state = total + gains.gain[entry], gains.after[entry]
    return total
