"""Column generation and time limits."""

from contextlib import suppress

import numpy as np
import pytest

from planner import Aggregation, Constraint, Message, Problem, Stream, Video
from studies.oracle import OracleFailed, optimum, upper_bound
from studies.oracle import solver as solver_module
from studies.oracle.programme import build_programme
from studies.oracle.solver import solve_integer, solve_relaxed


def cameras(seconds, *, streams=3, rate=10.0, aggregation=Aggregation.MOST_RECENT, worth=(1.0,)):
    """Cameras of different worth that share room for three frames a second; `worth` of frames in turn."""
    times = sorted((i / rate + s / 100, s) for i in range(int(seconds * rate)) for s in range(streams))
    messages = tuple(
        Message(s, t, t, t + 0.05, Video(), (1.0 + 3 * s) * worth[at % len(worth)], (1.0,))
        for at, (t, s) in enumerate(times)
    )
    constraint = Constraint("messages", 1.0, 3.0)
    return Problem(
        tuple(Stream(at, aggregation) for at in range(streams)), messages, 0, (constraint,), (), 0.0, seconds
    )


@pytest.mark.full
def test_arcs_left_out_at_first_are_added(monkeypatch):
    """The answer does not depend on the arcs one starts with."""
    problem = cameras(6.0)
    programme = build_programme(problem)
    assert programme.skips.max() > solver_module.FIRST_SKIPS
    monkeypatch.setattr(solver_module, "FIRST_SKIPS", 10_000)
    whole = solve_relaxed(programme)
    assert whole.best
    for skips in (2, 12):
        monkeypatch.setattr(solver_module, "FIRST_SKIPS", skips)
        grown = solve_relaxed(programme)
        assert grown.bound <= whole.cost * (1 - 1e-9)
        assert grown.cost == pytest.approx(whole.cost, rel=solver_module.CLOSE)
        assert grown.bound == pytest.approx(whole.cost, rel=solver_module.CLOSE)


@pytest.mark.full
def test_ranks_left_out_at_first_are_added(monkeypatch):
    """The bound does not depend on the ranks one starts with, and the fractions cost what they are worth."""
    programme = build_programme(cameras(4.0, aggregation=Aggregation.BEST, worth=(1.0, 0.5, 0.9, 2.0)))
    assert programme.ranks.rank.max() > solver_module.FIRST_SKIPS
    monkeypatch.setattr(solver_module, "FIRST_SKIPS", 10_000)
    whole = solve_relaxed(programme)
    assert whole.best
    for skips in (0, 3, 12):
        monkeypatch.setattr(solver_module, "FIRST_SKIPS", skips)
        grown = solve_relaxed(programme)
        assert grown.bound <= whole.cost * (1 - 1e-9)
        assert grown.cost >= whole.cost * (1 + 1e-9)
        assert grown.bound == pytest.approx(whole.cost, rel=solver_module.CLOSE)
        assert grown.cost == pytest.approx(whole.cost, rel=solver_module.CLOSE)


def test_no_time_for_any_plan():
    """When the time is up before the first plan is found, there is nothing to return."""
    with pytest.raises(OracleFailed, match="no plan"):
        optimum(cameras(20.0, streams=6), time_limit=0.0)


@pytest.mark.full
def test_plan_found_in_time_is_not_called_exact():
    """When the time is up after the first plan was found, it is returned with the bound so far."""
    problem = cameras(8.0, streams=6)
    for time_limit in (0.5 * 2**k for k in range(8)):
        with suppress(OracleFailed):
            solution = optimum(problem, time_limit)
            break
    assert not solution.exact
    assert solution.utility < solution.bound


def test_whole_messages_make_whole_arcs():
    """Only messages are asked to be whole; the paths through them are whole as well."""
    programme = build_programme(cameras(2.0))
    x = solve_integer(programme, time_limit=30.0).x
    assert np.abs(programme.sends(x) - np.round(programme.sends(x))).max() < 1e-6
    assert np.abs(x - np.round(x)).max() < 1e-6


@pytest.mark.full
def test_more_important_cameras_are_sent_more_often():
    """The bound's plan gives every camera its share, by what its frames are worth."""
    problem = cameras(10.0)
    solution = upper_bound(problem)
    sent = np.bincount([m.stream for m in problem.messages], weights=solution.sends)
    assert sent[2] > sent[1] > sent[0] > 0
