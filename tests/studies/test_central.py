"""The central decider: its windows and its flights."""

from dataclasses import replace

import pytest

from planner import Aggregation, Constraint
from planner.constraints import violations
from planner.validation import check_problem
from studies.central import CentralDecider, Uncertain, longest_window, mean_interval
from studies.policies import whenever_it_fits
from studies.workload import FEW_IMPORTANT, MIXED, mission


def test_windows_hold_facts_the_current_message_and_what_comes():
    """What was sent long ago and replaced since is forgotten; all else that matters is in the window."""
    flown = mission(MIXED, seed=0, seconds=10.0)
    decider = CentralDecider(flown, horizon=15)
    decider.fly(whenever_it_fits)
    decided = CentralDecider(flown, horizon=15)
    for index, message in enumerate(flown.messages):
        window = decided.window(index)
        check_problem(window)
        facts = [m for m in window.messages if m.sent]
        assert message._replace(sent=False) == window.messages[window.current]
        assert window.messages[window.current :] == flown.messages[index : index + 15]
        sent = [flown.messages[i] for i in decided.sends]
        recent = {m.t_gen for m in sent if m.t_sent >= message.t_sent - 0.5}
        last = {max((m.t_gen for m in sent if m.stream == s), default=None) for s in range(10)} - {None}
        assert {m.t_gen for m in facts} == recent | last
        if index in decider.sends:
            decided.send(index)


def test_windows_end_with_a_life_for_the_last_message():
    """A window ends one interval between sends after its last message, the last one with the mission."""
    flown = mission(MIXED, seed=0, seconds=30.0)
    decider = CentralDecider(flown, horizon=20)
    interval = mean_interval(flown)
    assert interval == pytest.approx(2.5)
    assert decider.window(0).t_end == flown.messages[19].t_gen + interval
    assert decider.window(len(flown.messages) - 20).t_end == 30.0
    assert decider.window(len(flown.messages) - 21).t_end == 30.0


def test_interval_between_sends_is_that_of_generation_when_all_fits():
    """Without a tight constraint a stream sends what it generates."""
    flown = mission(MIXED, seed=0, constraint=Constraint("messages", 1.0, 1000.0))
    assert mean_interval(flown) == pytest.approx(1.0, abs=0.1)
    assert mean_interval(replace(flown, constraints=())) == mean_interval(flown)


def test_longest_window_is_stretched_by_oversized_messages():
    """A message of four limits looks back four windows; a limit of zero lets nothing look back."""
    flown = mission(MIXED, seed=0, seconds=3.0)
    heavy = tuple(m._replace(use=(8.0,)) for m in flown.messages)
    assert longest_window(flown) == 0.5
    assert longest_window(replace(flown, messages=heavy)) == 2.0
    assert longest_window(replace(flown, constraints=(Constraint("messages", 0.5, 0.0),))) == 0.0


def test_flights_break_no_constraint_with_oversized_messages():
    """Facts reach back far enough for messages that need a stretched window."""
    drawn = mission(MIXED, seed=0, seconds=10.0)
    uneven = tuple(m._replace(use=(1.0 + 4.0 * (i % 7 == 0),)) for i, m in enumerate(drawn.messages))
    flown = replace(drawn, messages=uneven)
    sends = CentralDecider(flown, horizon=10).fly(whenever_it_fits)
    assert sends
    assert violations(flown, sends) == []


def test_futures_share_what_is_known():
    """All futures of a window decide the same message with the same facts; each is a valid problem."""
    flown = mission(FEW_IMPORTANT, seed=0, seconds=12.0)
    decider = CentralDecider(flown, horizon=20, forecast=True, futures=3)
    for index, message in enumerate(flown.messages):
        window = decider.window(index)
        assert isinstance(window, Uncertain)
        assert len(window.futures) == 3
        for future in window.futures:
            check_problem(future)
            assert future.messages[: window.current + 1] == window.messages[: window.current + 1]
            assert future.messages[future.current] == message
        if whenever_it_fits(window):
            decider.send(index)


def test_windows_know_the_newest_message_of_each_stream_of_current():
    """It may have been dropped, so that it is no fact."""
    flown = mission(MIXED, seed=0, seconds=10.0)
    flown = replace(flown, streams=tuple(s._replace(aggregation=Aggregation.CURRENT) for s in flown.streams))
    decider = CentralDecider(flown, horizon=15)
    assert all(stream.newest is None for stream in decider.window(0).streams)
    window = decider.window(40)
    before = flown.messages[:40]
    for at, stream in enumerate(window.streams):
        assert stream.newest == max(((m.t_gen, m.scale) for m in before if m.stream == at), default=None)
    check_problem(window)
