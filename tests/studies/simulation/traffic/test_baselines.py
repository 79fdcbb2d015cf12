"""Policies that do not plan."""

from dataclasses import replace

import pytest

from studies.simulation.records import Frame
from studies.simulation.traffic.baselines import Sender, Simple
from studies.simulation.traffic.flights import How
from studies.simulation.traffic.missions import WARM_UP, draw
from studies.simulation.traffic.scores import score

HOW = How(loss=0.0)


def fly(mission, *, apart, reserve):
    return Simple(mission, HOW, 0, apart, reserve).fly()


@pytest.fixture(scope="module")
def mission():
    """Two robots with images, of which each has a part that holds one."""
    return draw("mixed", 2, 0, WARM_UP + 5.0, latency=0.02)


@pytest.mark.parametrize("apart", [False, True])
@pytest.mark.parametrize("reserve", [False, True])
def test_small_samples_are_sent_and_the_rest_is_filled(mission, apart, reserve):
    """At once, every one that is known before; images use most of the limit, and no window exceeds it."""
    found = score(mission, fly(mission, apart=apart, reserve=reserve), 0.0)
    assert found.kept > 0.99
    assert found.age[1] < 0.03
    assert found.fill > 0.75
    assert found.over <= (0.01 if apart and reserve else 0.0)


def test_one_sender_keeps_the_limit_whatever_comes():
    """Samples of all sizes, at random."""
    mission = draw("random", 5, 0, WARM_UP + 5.0, latency=0.02)
    found = score(mission, fly(mission, apart=False, reserve=True), 0.0)
    assert (found.over, found.told) == (0.0, 0.0)
    assert found.fill > 0.8


@pytest.mark.full
def test_what_is_larger_than_a_part_goes_by_turns_or_is_saved_up_for():
    """In turns the union keeps the limit; who saves up sends more, and several may do so at once. Small samples go."""
    mission = draw("mixed", 8, 0, WARM_UP + 10.0, latency=0.02)
    turns, saved = (score(mission, fly(mission, apart=True, reserve=reserve), 0.0) for reserve in (False, True))
    assert turns.over == 0.0
    assert saved.over > 0.05
    assert 0.4 < turns.fill < saved.fill < 1.15
    assert min(turns.kept, saved.kept) > 0.99
    assert max(turns.silence.values()) < 1.0


@pytest.mark.full
def test_turns_are_as_close_as_messages_allow():
    """Five of equal size in a window of the limit that holds five."""
    mission = draw("uniform-most", 10, 0, 30.0, latency=0.02)
    found = score(mission, fly(mission, apart=True, reserve=False), 0.0)
    assert found.over == 0.0
    assert found.fill > 0.85


def frames(mission, *given):
    """A mission of these frames alone: (time, key, size)."""
    streams = {frame.key: message for frame, message in zip(mission.frames, mission.problem.messages, strict=True)}
    made = [Frame("r0", key, t, size, {}) for t, key, size in given]
    messages = tuple(streams[f.key]._replace(t_gen=f.t_gen, t_sent=f.t_gen, use=(float(f.size),)) for f in made)
    small = frozenset(i for i, frame in enumerate(made) if not frame.key.endswith("camera"))
    return replace(
        mission, frames=tuple(made), problem=replace(mission.problem, messages=messages), small=small, carried=1000.0
    )


def sent(flight):
    return [(air.frame.key, air.frame.t_gen) for air in flight.on_air]


def test_the_newest_image_waits_a_moment_and_every_alarm(mission):
    """Until the window has room for them; small ones first. What has waited too long is dropped."""
    given = [(0.0, "r0/camera", 900), (0.1, "r0/camera", 500), (0.3, "r0/alarm", 200), (0.4, "r0/alarm", 200)]
    newest = [(0.42, "r0/camera", 500), (0.45, "r0/camera", 500)]
    flight = fly(frames(mission, *given, *newest), apart=False, reserve=False)
    assert sent(flight) == [("r0/camera", 0.0), ("r0/alarm", 0.3), ("r0/alarm", 0.4), ("r0/camera", 0.45)]
    assert flight.on_air[1].t == flight.on_air[3].t == pytest.approx(0.5, abs=0.01)
    assert len(sent(fly(frames(mission, *given), apart=False, reserve=False))) == 3


def test_a_reserve_keeps_room_for_small_samples(mission):
    """As much as they used in the last window: an image that would take it waits until they need less."""
    given = [(0.0, "r0/odometry", 200), (0.45, "r0/camera", 700)]
    free, kept = (fly(frames(mission, *given), apart=False, reserve=reserve) for reserve in (False, True))
    assert free.on_air[1].t == 0.45
    assert kept.on_air[1].t == pytest.approx(0.5, abs=0.01)


def test_a_sender_without_traffic_sends_nothing(mission):
    """Nothing waits, nothing is taken."""
    assert Sender(1000.0, 0.5, reserve=True).take(0.0, mission) == []
