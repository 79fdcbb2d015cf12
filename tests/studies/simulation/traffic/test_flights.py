"""Teams and central deciders in real traffic."""

import itertools

import pytest

from planner import Linear, Step, Video
from studies.simulation.traffic.flights import How, crew, fly, fly_alone
from studies.simulation.traffic.kinds import Kind
from studies.simulation.traffic.missions import ALONE, WARM_UP, draw, draw_from
from studies.simulation.traffic.scores import score
from studies.simulation.traffic.workloads import MBIT, SMALL, Workload


@pytest.mark.full
def test_one_decider_keeps_the_limit_at_any_latency():
    """It sends for all streams, and waits for nobody."""
    for latency in (0.02, 1.0):
        mission = draw("random", 3, 0, WARM_UP + 3.0, latency=latency)
        by_one, flight = fly_alone(mission, How(latency=latency, loss=0.0), 0)
        found = score(by_one, flight, 0.0)
        assert {air.robot for air in flight.on_air if air.frame is not None} == {ALONE}
        assert found.over == 0.0
        assert found.fill > 0.5


@pytest.mark.full
@pytest.mark.parametrize("transport", ["unicast", "broadcast"])
def test_a_team_flies_real_traffic(transport):
    """Its samples are counted by robot, and everybody hears them who wants them."""
    how = How("announce", transport, loss=0.0)
    mission = draw("random", 3, 0, WARM_UP + 3.0, latency=0.02, everybody=how.broadcasts)
    flight = fly(mission, how, 0)
    assert {air.robot for air in flight.on_air if air.frame is not None} == {"r0", "r1", "r2"}
    assert len({delivery.receiver for delivery in flight.deliveries}) == (4 if how.broadcasts else 1)


@pytest.mark.parametrize("latency", [0.05, 0.2])
@pytest.mark.full
def test_a_large_team_soon_knows_how_long_news_take(latency):
    """However few digests hold echoes: those who know no way come first, and announcements make room for them."""
    mission = draw("cameras", 8, 0, 12.0, latency=latency)
    flight = fly(mission, How(latency=latency, loss=0.0), 0)
    known = [core.view.staleness.longest_way for core in flight.cores.values()]
    assert known == pytest.approx([latency] * 9, rel=0.01)


@pytest.mark.full
@pytest.mark.parametrize("team", ["announce/unicast", "announce/broadcast", "split/unicast"])
def test_a_large_team_keeps_the_limit_and_the_allowance_and_nobody_is_silent(team):
    """From the first seconds on, when each robot knows but its own streams."""
    how = How(*team.split("/"))
    mission = draw("crowd", 30, 0, WARM_UP + 5.0, latency=0.02, everybody=how.broadcasts)
    found = score(mission, fly(mission, how, 0), how.loss)
    assert found.over <= 0.02
    assert found.told <= found.allowed
    assert found.sent > (0.65 if how.coordination == "announce" else 0.4) * found.room
    assert max(found.silence.values()) < 4.0


@pytest.mark.full
def test_in_a_long_window_small_samples_go_on_after_a_team_began():
    """It is not used up at first, as little is known of rates then, nor so that nothing goes until that leaves it."""
    camera = Kind("camera", Video(1 / 30, 10.0), (10.0, 10.0), (5_000, 5_000))
    workload = Workload("long", ((camera, SMALL[0]),) * 2, 0.4 * MBIT, 10.0)
    mission = draw_from(workload, 0, 13.0, latency=0.02)
    flight = fly(mission, How(loss=0.0), 0)
    times = sorted(air.t for air in flight.on_air if air.frame is not None and air.frame.key.endswith("odometry"))
    assert max(later - earlier for earlier, later in itertools.pairwise(times)) < 0.5
    found = score(mission, flight, 0.0)
    assert found.worst < 1.02
    assert found.kept > 0.95


@pytest.mark.full
def test_nobody_takes_what_others_say_for_hollow_where_most_samples_are_worth_nothing():
    """The last one still counts: it is for nothing that others claim that the next ones are dropped."""
    lasting = Kind("lasting", Step(1.0, 10.0), (10.0, 12.0), (45_000, 56_000))
    small = Kind("small", Linear(1.0, 0.7), (1.0, 1.4), (6_000, 8_000))
    mission = draw_from(Workload("lasting", ((lasting, small),) * 3, 3.0 * MBIT, 0.5), 0, 12.0, latency=0.02)
    flight = fly(mission, How(loss=0.0), 0)
    assert not any(core.coordination.keeps for core in flight.cores.values())


@pytest.mark.full
def test_messages_much_larger_than_a_part_use_their_turns():
    """Each waits for the next turn of its robot, however soon another sample may come."""
    frames = Kind("frames", Step(1.0, 2.0), (7.0, 9.0), (8_200, 9_000), at_random=True)
    workload = Workload("frames", ((frames,),) * 12, 0.3 * MBIT, 1.0)
    mission = draw_from(workload, 0, WARM_UP + 10.0, latency=0.002)
    flight = fly(mission, How(loss=0.0), 0)
    assert all(core.coordination.equal.by_clock for robot, core in flight.cores.items() if robot != "op")
    found = score(mission, flight, 0.0)
    assert found.over == 0.0
    assert found.fill > 0.55


@pytest.mark.full
def test_in_a_turn_that_sample_goes_that_gains_most():
    """Not the oldest: one kind of frames is worth next to nothing for seconds after each, the other one soon again."""
    lasting = Kind("lasting", Step(1.0, 10.0), (6.0, 8.0), (3_600, 4_000))
    frames = Kind("frames", Video(1 / 30, 10.0), (3.0, 3.5), (5_500, 6_000), weight=8.0)
    workload = Workload("both", ((lasting, frames),) * 8, 0.3 * MBIT, 0.5)
    flight = fly(draw_from(workload, 0, WARM_UP + 10.0, latency=0.02), How(loss=0.0), 0)
    assert all(core.coordination.equal.by_clock for robot, core in flight.cores.items() if robot != "op")
    sent = [air.frame.key for air in flight.on_air if air.frame is not None and air.t > WARM_UP]
    assert sum("frames" in key for key in sent) > 3 * sum("lasting" in key for key in sent)


def test_further_settings_are_the_cores():
    """By their names; one that the core does not have is refused."""
    mission = draw("random", 2, 0, 2.0, latency=0.02)
    assert crew(mission, How(settings=(("horizon", 90),)), 0).settings.horizon == 90
    with pytest.raises(TypeError):
        crew(mission, How(settings=(("none", 1),)), 0)
