"""Forecasts from periods and means: what they know and what they do not."""

from dataclasses import replace

import pytest

from planner import Linear, Video
from planner.constraints import violations
from planner.validation import check_problem
from studies.central import CentralDecider
from studies.forecast import EARLY, Forecaster
from studies.mixed_workload import mixed_mission
from studies.policies import whenever_it_fits
from studies.workload import FEW_IMPORTANT, MIXED, MOST_IMPORTANT, mission


def test_regular_streams_are_foreseen_exactly():
    """Without jitter and once every stream was heard, the forecast is what comes."""
    flown = mission(MOST_IMPORTANT, seed=2, seconds=20.0)
    expected = Forecaster(flown).expect(50, 30)
    for message, truth in zip(expected, flown.messages[51:81], strict=True):
        assert message.stream == truth.stream
        assert message.t_gen == pytest.approx(truth.t_gen, abs=1e-5)
        assert message.t_rcv - message.t_sent == pytest.approx(0.01)


def test_jittered_streams_are_expected_early_by_their_deviation():
    """On average a message comes by a part of the standard deviation later than expected, never before now."""
    flown = mission(FEW_IMPORTANT, seed=2, seconds=100.0)
    forecaster, late = Forecaster(flown), []
    for index in range(200, 900, 10):
        now = flown.messages[index].t_gen
        expected = forecaster.expect(index, 40)
        assert all(now < m.t_gen for m in expected)
        for stream in range(10):
            coming = [m.t_gen for m in flown.messages[index + 1 :] if m.stream == stream][1]
            foreseen = [m.t_gen for m in expected if m.stream == stream]
            late += [coming - foreseen[1]] if len(foreseen) > 1 else []
    assert sum(late) / len(late) == pytest.approx(EARLY * 0.1, abs=0.03)


def test_slopes_are_means_so_far_and_other_utilities_those_of_the_first():
    """Of single messages to come nothing is known."""
    flown = mission(FEW_IMPORTANT, seed=1, seconds=10.0)
    own = [m for m in flown.messages[:31] if m.stream == 4]
    expected = [m for m in Forecaster(flown).expect(30, 20) if m.stream == 4]
    slope = sum(m.utility.slope for m in own) / len(own)
    assert {type(m.utility) for m in expected} == {Linear}
    assert [m.utility.slope for m in expected] == pytest.approx([slope] * len(expected))
    mixed = replace(flown, messages=(flown.messages[0]._replace(utility=Video()), *flown.messages[1:]))
    first = flown.messages[0].stream
    assert {m.utility for m in Forecaster(mixed).expect(30, 20) if m.stream == first} == {Video()}


@pytest.mark.parametrize("index", [0, 3, 40, 200])
def test_what_is_still_to_come_changes_no_forecast(index):
    """Whatever the rest of a mission will be, what is expected of it now is the same."""
    flown = mission(FEW_IMPORTANT, seed=3, seconds=40.0)
    other = mission(FEW_IMPORTANT, seed=4, seconds=40.0)
    now = flown.messages[index].t_gen
    rest = tuple(m._replace(use=(3.0,), scale=7.0) for m in other.messages if m.t_gen > now)
    changed = replace(flown, messages=(*flown.messages[: index + 1], *rest))
    first, second = Forecaster(flown, futures=3), Forecaster(changed, futures=3)
    assert first.expect(index, 30) == second.expect(index, 30)
    assert first.sample(index, 30) == second.sample(index, 30)
    assert first.life(index) == second.life(index)


def test_streams_are_expected_once_they_were_heard_and_by_yardsticks_before():
    """Specs tell what a stream will carry, hindsight its rhythm, too; one without rhythm it does not foresee."""
    flown = mission(MOST_IMPORTANT, seed=4, seconds=10.0)
    heard = {m.stream for m in flown.messages[:4]}
    assert {m.stream for m in Forecaster(flown).expect(3, 40)} == heard
    for knowledge in ("specs", "hindsight"):
        assert {m.stream for m in Forecaster(flown, knowledge=knowledge).expect(0, 10)} == set(range(10))
        sampled = Forecaster(flown, 2, knowledge=knowledge).sample(0, 10)
        assert [{m.stream for m in future} for future in sampled] == [set(range(10))] * 2
    silent = flown.messages[-1].stream
    rare = replace(flown, messages=tuple(m for m in flown.messages[:-1] if m.stream != silent))
    rare = replace(rare, messages=(*rare.messages, flown.messages[-1]))
    assert silent not in {m.stream for m in Forecaster(rare, knowledge="hindsight").expect(5, 50)}
    assert silent not in {m.stream for m in Forecaster(rare, knowledge="hindsight").expect(len(rare.messages) - 1, 5)}


def test_flights_by_forecast_keep_constraints_and_end_with_the_mission():
    """Windows are valid problems; the last ones say that nothing comes after them."""
    flown = mission(FEW_IMPORTANT, seed=0, seconds=12.0)
    decider = CentralDecider(flown, horizon=20, forecast=True)
    for index in range(len(flown.messages)):
        window = decider.window(index)
        check_problem(window)
        assert window.t_end <= flown.t_end
        assert window.goes_on or window.t_end == flown.t_end
        if whenever_it_fits(window):
            decider.send(index)
    assert not window.goes_on
    assert violations(flown, decider.sends) == []


def test_futures_spread_evenly_around_what_comes():
    """Each future is a possible one: after now, in order, as many as asked for, on average neither early nor late."""
    flown = mission(FEW_IMPORTANT, seed=2, seconds=100.0)
    forecaster, late = Forecaster(flown, futures=8), []
    for index in range(200, 900, 10):
        now = flown.messages[index].t_gen
        futures = forecaster.sample(index, 40)
        assert len(futures) == 8
        for future in futures:
            times = [m.t_gen for m in future]
            assert times == sorted(times)
            assert len(times) == 40
            assert times[0] > now
        for stream in range(10):
            coming = [m.t_gen for m in flown.messages[index + 1 :] if m.stream == stream][1]
            sampled = [[m.t_gen for m in future if m.stream == stream][1] for future in futures]
            late.append(coming - sum(sampled) / 8)
    assert sum(late) / len(late) == pytest.approx(0.0, abs=0.03)


def test_futures_take_what_messages_use_from_those_seen():
    """In the mean over futures a message uses what the stream used in the mean, in each of them another part of it."""
    flown = mixed_mission(MIXED, seed=1, seconds=50.0)
    forecaster = Forecaster(flown, futures=8)
    futures, expected = forecaster.sample(100, 20), forecaster.expect(100, 20)
    for stream in {m.stream for m in expected}:
        mean = next(m.use[0] for m in expected if m.stream == stream)
        first = [next(m.use[0] for m in future if m.stream == stream) for future in futures]
        assert sum(first) / 8 == pytest.approx(mean, rel=0.1)
        assert len(set(first)) > 1


def test_the_same_seed_samples_the_same_futures():
    """Another seed deals the deviations out otherwise."""
    flown = mission(FEW_IMPORTANT, seed=2, seconds=20.0)
    first, again, other = (Forecaster(flown, 4, seed).sample(50, 20) for seed in (1, 1, 2))
    assert first == again
    assert first != other
