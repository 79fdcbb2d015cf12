"""Robots whose applications begin together send one large sample each first, one after the other."""

import math
from dataclasses import replace

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

SIZE, BEGAN = 1_000, 5.0


@pytest.fixture
def view(make_specs):
    """Five robots and an operator of whom nobody knows anything, but that a camera of ours has just begun."""
    view = SharedView(CoreSettings("r3", "z3"), make_specs())
    for name in ("op", "r1", "r2", "r4", "r5"):
        view.add_peer(0.0, name, f"z-{name}")
    view.subscribers.set_own(("robot/**",))
    begin(view, "r3")
    return view


def begin(view, robot, size=SIZE):
    stream = view.streams.touch(BEGAN, robot, f"robot/{robot}/camera")
    stream.match(matching=True)
    stream.note_generated(1, Generated(BEGAN, size, 1.0))
    return stream


def send(view, robot, at=BEGAN):
    view.traffic.note_sent(view.streams.known(robot, f"robot/{robot}/camera"), 1, Sent(at, at, SIZE, 1.0))


def wait(view, now=BEGAN):
    """Return how long after its beginning our stream may send [turns]."""
    at = first_at(now, view, view.streams.known("r3", "robot/r3/camera"), limits_of(view.specs, 0.02, 6))
    return (at - BEGAN) / TUNING.first_apart


def test_each_lets_those_go_first_whose_names_come_before_its_own(view):
    """Of these three nobody knows that they do not begin in this moment."""
    assert wait(view) == pytest.approx(3.0)


def test_who_has_sent_lets_all_others_send_once(view):
    """Then it goes on."""
    send(view, "r3")
    assert wait(view) == pytest.approx(6.0)


def test_nobody_waits_for_long(view):
    """However many may begin."""
    for number in range(20):
        view.add_peer(0.0, f"a{number}", f"za{number}")
    at = first_at(BEGAN, view, view.streams.known("r3", "robot/r3/camera"), limits_of(view.specs, 0.02, 26))
    assert BEGAN < at <= BEGAN + TUNING.first_time
    assert wait(view, BEGAN + TUNING.first_time) == -math.inf


def test_who_is_known_to_have_sent_is_not_waited_for(view):
    """Nor is who takes no part; a stream that has sent nothing yet, or is small, says nothing."""
    begin(view, "r1")
    begin(view, "r2", size=1)
    send(view, "r2")
    assert wait(view) == pytest.approx(3.0)
    send(view, "r1")
    assert wait(view) == pytest.approx(2.0)
    view.peers["z-r2"].take_part(plain=True)
    assert wait(view) == pytest.approx(1.0)


def test_where_few_may_begin_nobody_waits(view):
    """Two robots seldom meet in the same moment."""
    for name in ("r1", "r2", "r4"):
        begin(view, name)
        send(view, name)
    assert wait(view) == -math.inf


def test_where_news_take_longer_robots_are_further_apart(view):
    """So that each hears of those before it."""
    offset = view.peers["z-r1"].offset
    offset.heard(1.0, 1.05)
    offset.echoed(2.0, 2.05)
    assert view.staleness.longest_way == pytest.approx(0.05)
    assert 3.5 < wait(view) <= 6.0


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


@pytest.mark.parametrize(("robots", "seed"), [(4, 3), (8, 2)])
def test_a_team_that_begins_in_one_moment_loses_no_small_sample(robots, seed):
    """Two seconds after its daemons: nearly two frames fill the limit."""
    small, lost, held = begins_together(robots, seed)
    assert len(small) > 20 * robots
    assert not lost
    assert held <= 1.1
