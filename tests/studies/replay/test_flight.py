"""Recorded traffic flown by cores."""

from dataclasses import replace

import numpy as np
import pytest

from studies.replay.flight import Flight
from studies.replay.samples import Fate, Passed
from studies.replay.violations import violating
from tests.studies.replay.traffic import POSE, mission, samples, spec


def flown(told, text=None, robots=("r1",), origin=100.0, **how):
    flight = Flight(mission(text, robots), iter(told), **{"iterations": 50, "seed": 0, "origin": origin, **how})
    seen = []
    outcomes = flight.fly(seen.append)
    return outcomes, flight, seen


def fates(outcomes):
    columns = outcomes.columns()
    return [outcomes.reasons[fate] for fate in columns.fate.tolist()]


@pytest.mark.full
def test_what_is_worth_most_goes_within_the_limit():
    """The core of a daemon decides; what was red goes rather than what was not."""
    outcomes, flight, seen = flown(samples(seconds=60))
    columns = outcomes.columns()
    assert len(outcomes) == 120
    assert columns.t[0] == 0.0
    assert 50 <= columns.sent.sum() <= 61  # one in a second
    assert not violating(outcomes, columns).any()
    assert set(fates(outcomes)) <= {"forwarded", "dropped:constraint", "dropped:planner", "dropped:superseded"}
    assert columns.scale[columns.sent].mean() > columns.scale[~columns.sent].mean()
    assert (columns.t_rcv - columns.t_sent)[columns.sent].min() >= 0.01
    assert sum(count for _, count in outcomes.seconds.values()) > 0
    assert seen[-1] == columns.t[-1]
    assert flight.told_on_air()[1].sum() > 0


@pytest.mark.full
def test_what_is_lost_is_sent_in_vain():
    """About so much of it: it counts for the limit, and nobody gains by it. The same seed loses the same."""
    lossy = replace(mission(), loss=0.4)
    flights = [Flight(lossy, iter(samples(seconds=60)), iterations=50, seed=seed, origin=100.0) for seed in (1, 1, 2)]
    one, same, other = (flight.fly(lambda _: None).columns() for flight in flights)
    lost = np.concatenate([np.isnan(flown.t_rcv[flown.sent]) for flown in (one, other)])
    assert 50 <= one.sent.sum() <= 61
    assert 0.2 < lost.mean() < 0.6
    assert np.array_equal(one.t_rcv, same.t_rcv, equal_nan=True)
    assert not np.array_equal(one.t_rcv, other.t_rcv, equal_nan=True)


def test_the_same_traffic_is_decided_alike():
    """Whatever the recording's clock began with."""
    one, other = (flown(samples(start=start), origin=start)[0] for start in (100.0, 1.5e9))
    assert fates(one) == fates(other)


def test_samples_are_read_as_they_fly():
    """No more than one is taken in before its time."""
    read = []

    def reading():
        for each in samples():
            read.append(each.t)
            yield each

    flight = Flight(mission(), reading(), iterations=50, seed=0, origin=100.0)
    ahead = []
    flight.fly(lambda done: ahead.append(len(read) - done / 0.5))
    assert len(ahead) > 10
    assert max(ahead) <= 2


@pytest.mark.full
def test_what_no_spec_covers_passes_and_leaves_less_to_others():
    """Undecided, as with a daemon; so does what bypasses."""
    told = sorted([*samples(), *samples(key="r1/pose", size=900)], key=lambda each: each.t)
    outcomes, *_ = flown(told, spec())
    assert fates(outcomes).count("passed:no-spec") == 40
    alone, *_ = flown(samples(), spec())
    assert outcomes.columns().sent.sum() - 40 < alone.columns().sent.sum()
    bypassing, *_ = flown(told, spec() + POSE + "bypass = true\n")
    assert fates(bypassing).count("passed:bypass") == 40
    known, *_ = flown([Passed("r1", each.t, 1, 900) if each.key == "r1/pose" else each for each in told], spec())
    assert len(known) == 40
    assert known.columns().sent.sum() == outcomes.columns().sent.sum() - 40


def test_fates_that_were_recorded_stand_beside_those_of_the_flight():
    """By robot and number."""
    told = [one for each in samples() for one in (each, Fate("r1", each.number, "dropped:gone", each.t))]
    outcomes, *_ = flown(told)
    assert {outcomes.reasons[i] for i in outcomes.columns().recorded} == {"dropped:gone"}
    assert outcomes.note(Fate("r1", 3, "forwarded", 0.0)) is None


def test_robots_share_the_limit():
    """Each has a core of its own; a sample keeps the age it was published with."""
    told = sorted(
        [*samples(30), *(replace(each, t_gen=each.t - 0.3) for each in samples(30, key="r2/camera", seed=1))],
        key=lambda each: each.t,
    )
    outcomes, *_ = flown(told, robots=("r1", "r2"))
    columns = outcomes.columns()
    sent = [sum(columns.sent & (columns.stream == stream)) for stream in (0, 1)]
    assert min(sent) > 5
    assert sum(sent) <= 33
    assert np.ptp((columns.t - columns.t_gen)[columns.stream == 1] - 0.3) < 1e-9
