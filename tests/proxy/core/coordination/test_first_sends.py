"""Robots whose applications begin together send one large sample each first, one after the other."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from proxy.core.coordination.claims import first_at
from proxy.core.coordination.tuning import TUNING
from proxy.core.model.limits import limits_of
from proxy.core.model.settings import CoreSettings
from proxy.core.view.stream import Generated, Sent
from proxy.core.view.view import SharedView
from studies.simulation.traffic.flights import How, crew
from studies.simulation.traffic.missions import draw
from tests.seeds import seeds

SIZE, BEGAN = 1_000, 5.0


OTHERS = ("op", "r1", "r2", "r4", "r5")


@pytest.fixture
def make_view(make_specs):
    """Return a robot of six, of whom nobody knows anything, but that its own camera has just begun."""

    def make(robot, *others):
        view = SharedView(CoreSettings(robot, f"z-{robot}"), make_specs())
        for name in others:
            view.add_peer(0.0, name, f"z-{name}")
        view.subscribers.set_own(("robot/**",))
        begin(view, robot)
        return view

    return make


@pytest.fixture
def view(make_view):
    return make_view("r3", *OTHERS)


def begin(view, robot, size=SIZE):
    stream = view.streams.touch(BEGAN, robot, f"robot/{robot}/camera")
    stream.match(matching=True)
    stream.note_generated(1, Generated(BEGAN, size, 1.0))
    return stream


def send(view, robot, at=BEGAN):
    view.traffic.note_sent(view.streams.known(robot, f"robot/{robot}/camera"), 1, Sent(at, at, SIZE, 1.0))


def first(view, now):
    """Return when our stream may send, as it is at a time; −∞: then."""
    robot = view.settings.robot
    limits = limits_of(view.specs, 0.02, len(view.peers) + 1)
    return first_at(now, view, view.streams.known(robot, f"robot/{robot}/camera"), limits)


def may_send(view, until=TUNING.first_time):
    """Return the milliseconds after its beginning in which our stream may send."""
    return [ms for ms in range(round(1e3 * until)) if first(view, BEGAN + 1e-3 * ms) == -math.inf]


def test_each_sends_in_a_turn_of_its_own(make_view):
    """So far apart that each hears of those before it; who missed its turn has another one."""
    everybody = {"r3", *OTHERS}
    turns = {robot: may_send(make_view(robot, *everybody - {robot})) for robot in everybody}
    assert all(turns.values())
    times = sorted((ms, robot) for robot, of in turns.items() for ms in of)
    gaps = [later - ms for (ms, robot), (later, other) in pairwise(times) if robot != other]
    assert min(gaps) >= 1e3 * TUNING.first_time / len(everybody) * (1.0 - TUNING.first_part) - 1


def test_who_waits_is_told_when_its_turn_is(view):
    """It is the next one."""
    turns = may_send(view)
    waits = next(ms for ms in range(400) if ms not in turns)
    at = first(view, BEGAN + 1e-3 * waits)
    assert BEGAN < at <= BEGAN + TUNING.first_time
    assert first(view, at + 1e-6) == -math.inf


def test_turns_are_by_the_wall_clock(make_view):
    """However late its own streams began."""
    one, other = make_view("r3", *OTHERS), make_view("r3", *OTHERS)
    other.clocks.set(offset=100.1, error=0.0)
    assert may_send(one) != may_send(other)


def test_nobody_waits_for_long(view):
    """However many may begin."""
    for number in range(20):
        view.add_peer(0.0, f"a{number}", f"za{number}")
    assert may_send(view)
    waits = [at for at in (first(view, BEGAN + 1e-3 * ms) for ms in range(400)) if at > -math.inf]
    assert max(waits) <= BEGAN + TUNING.first_time
    assert first(view, BEGAN + TUNING.first_time) == -math.inf


def test_who_takes_no_part_is_not_waited_for(make_view):
    """Nor is who is known to have sent; a stream that has sent nothing yet, or is small, says nothing."""
    view = make_view("r3", "r1", "r2", "r4", "r5")
    begin(view, "r1")
    begin(view, "r2", size=1)
    send(view, "r2")
    assert len(may_send(view)) < 400
    view.peers["z-r4"].take_part(plain=True)
    assert len(may_send(view)) < 400
    send(view, "r1")
    assert len(may_send(view)) == 400


def test_where_few_may_begin_nobody_waits(view):
    """Two robots seldom meet in the same moment."""
    for name in ("r1", "r2", "r4"):
        begin(view, name)
        send(view, name)
    assert len(may_send(view)) == 400


def begins_together(robots, seed):
    """Small samples of a flight with cameras that all begin within 50 ms, those not sent, and the fullest window."""
    mission = draw("mixed", robots, seed, 3.0, latency=0.005)
    random, begins = np.random.default_rng(seed), {}
    for frame in mission.frames:
        begins.setdefault(frame.key, 2.0 + random.uniform(0.0, 0.05) - frame.t_gen)
    frames = [replace(frame, t_gen=frame.t_gen + begins[frame.key]) for frame in mission.frames]
    team = crew(mission, How(latency=0.005, loss=0.0), seed)
    team.run(sorted(frames, key=lambda frame: frame.t_gen), 6.0)
    sent = {id(air.frame) for air in team.on_air if air.frame is not None}
    small = [frame for frame in frames if frame.size < 1000]
    times, sizes = np.array([(air.t, air.size) for air in sorted(team.on_air, key=lambda air: air.t)]).T
    sums = np.concatenate(([0.0], np.cumsum(sizes)))
    held = sums[1:] - sums[np.searchsorted(times, times - mission.window + 1e-9)]
    return small, [frame for frame in small if id(frame) not in sent], held.max() / mission.limit


@pytest.mark.full
@pytest.mark.parametrize("seed", seeds(7, few=3))
@pytest.mark.parametrize(("robots", "fullest"), [(4, 1.1), (8, 1.4)])
def test_a_team_that_begins_in_one_moment_loses_no_small_sample(robots, fullest, seed):
    """Two seconds after its daemons: nearly two frames fill the limit, and news of eight robots take a quarter."""
    small, lost, held = begins_together(robots, seed)
    assert len(small) > 20 * robots
    assert not lost
    assert held <= fullest
