"""What flights of real traffic reached: of hand-made ones, with answers that are known."""

from dataclasses import dataclass, field, replace

import pytest

from planner.definition import utility
from studies.simulation.missions import OPERATOR
from studies.simulation.records import Delivery, OnAir
from studies.simulation.scores import scored
from studies.simulation.traffic.missions import WARM_UP, alone, draw
from studies.simulation.traffic.scores import score, worth

LATENCY = 0.02


@dataclass
class Flight:
    """Frames that are sent when they are generated, and what else is on the air."""

    deliveries: list[Delivery] = field(default_factory=list)
    on_air: list[OnAir] = field(default_factory=list)

    def send(self, mission, index, *, late=0.0, lost=False, copies=1, to=OPERATOR):
        frame = mission.frames[index]
        t_sent = frame.t_gen + late
        self.deliveries.append(Delivery(frame, t_sent, None if lost else t_sent + LATENCY, to))
        self.on_air.append(OnAir(t_sent, frame.robot, copies * frame.size, frame))


@pytest.fixture(scope="module")
def mission():
    """Two robots for a few seconds."""
    return draw("mixed", 2, 0, WARM_UP + 3.0, latency=LATENCY)


def flown(mission, indices, **how):
    flight = Flight()
    for index in indices:
        flight.send(mission, index, **how)
    return flight


def due(mission, *kinds):
    frames = enumerate(mission.frames)
    return [i for i, f in frames if f.t_gen >= WARM_UP and (not kinds or f.key.split("/")[1] in kinds)]


def test_utility_is_the_planners(mission):
    """From the end of the warm-up on, of most recent samples and of sums."""
    every = range(0, len(mission.frames), 3)
    expected = utility(scored(mission.problem, WARM_UP), every)
    assert score(mission, flown(mission, every), 0.0).utility == pytest.approx(expected)
    assert expected > 0.0
    images = [i for i in every if i not in mission.small]
    assert score(mission, flown(mission, every), 0.0).large == pytest.approx(worth(mission, dict.fromkeys(images, 0.0)))
    assert worth(mission, {}) == 0.0
    assert score(mission, Flight(), 0.0).utility == 0.0


def test_what_each_receiver_gets_is_worth_something(mission):
    """As far as it is one of those that count; the one that decides for all sends to these."""
    shared = replace(mission, interests={**mission.interests, "r0": ("r1/**",)}, receivers=(OPERATOR, "r0"))
    some = [i for i, frame in enumerate(mission.frames) if frame.robot == "r1" and frame.t_gen >= WARM_UP][:40]
    to_one, to_both = flown(mission, some), flown(mission, some)
    for index in some:
        to_both.send(mission, index, to="r0")
    assert score(shared, to_both, 0.0).utility == pytest.approx(2.0 * score(mission, to_one, 0.0).utility)
    assert score(mission, to_both, 0.0).utility == score(mission, to_one, 0.0).utility
    assert alone(shared).interests == {"all": (), OPERATOR: ("**",), "r0": ("r1/**",)}


def test_small_samples_are_awaited_by_those_who_want_their_keys(mission):
    """A robot that wants one kind of another one is no further receiver of the rest."""
    small = sorted(i for i in mission.small if mission.frames[i].t_gen >= WARM_UP)
    shared = replace(mission, interests={**mission.interests, "r0": ("r1/odometry",)})
    odometry = [i for i in small if mission.frames[i].key == "r1/odometry"]
    every = score(mission, flown(mission, small), 0.0)
    assert every.arrived == 1.0
    assert score(shared, flown(mission, small), 0.0).arrived == len(small) / (len(small) + len(odometry))


def test_red_that_is_no_longer_there_is_lost():
    """Of cameras of `current`, as the planner's definition has it; the same flight gains more by most recent frames."""
    flown_over = {name: draw(name, 2, 5, WARM_UP + 20.0, latency=LATENCY) for name in ("cameras-current", "cameras")}
    reached = {}
    for name, over in flown_over.items():
        every = range(0, len(over.frames), 17)
        reached[name] = score(over, flown(over, every), 0.0).utility
        assert reached[name] == pytest.approx(utility(scored(over.problem, WARM_UP), every))
    assert reached["cameras-current"] < reached["cameras"]


def test_what_is_lost_is_drawn_alike_for_all(mission):
    """Two flights that send the same are worth the same, whatever was lost on their ways."""
    every = range(len(mission.frames))
    arrived, lost = (score(mission, flown(mission, every, lost=lost), 0.2).utility for lost in (False, True))
    half = flown(mission, every)
    half.deliveries[::2] = [Delivery(d.frame, d.t_sent, None, d.receiver) for d in half.deliveries[::2]]
    assert score(mission, half, 0.2).utility == pytest.approx(arrived, rel=1e-6)
    assert 0.0 < arrived < score(mission, flown(mission, every), 0.0).utility
    assert lost > 0.0


def test_small_samples_are_counted_and_aged(mission):
    """Sent, arrived, and how old they were then; images are not among them."""
    small = sorted(set(due(mission)) & mission.small)
    flight = flown(mission, small[::2], late=0.1)
    for index in small[1::4]:
        flight.send(mission, index, lost=True)
    for index in due(mission, "camera"):
        flight.send(mission, index, late=1.0)
    found = score(mission, flight, 0.0)
    assert found.kept == pytest.approx(0.75, abs=0.01)
    assert found.arrived == pytest.approx(0.5, abs=0.01)
    assert found.age == pytest.approx((0.12, 0.12))
    assert found.has_small


def test_alarms_are_counted():
    """Those that were generated after the warm-up, and those that were sent."""
    mission = draw("mixed", 8, 0, WARM_UP + 10.0, latency=LATENCY)
    alarms = sorted(set(due(mission)) & mission.alarms)
    found = score(mission, flown(mission, alarms[1:]), 0.0)
    assert (found.alarms, found.alarms_sent) == (len(alarms), len(alarms) - 1)


def test_windows_hold_copies_and_what_robots_tell_each_other(mission):
    """A sample is over when the closed window that ends with it holds more than the limit."""
    first = due(mission, "camera")[0]
    sizes = [mission.frames[first].size] * 2
    flight = flown(mission, [first], copies=2)
    assert score(mission, flight, 0.0).worst == pytest.approx(sum(sizes) / mission.limit)
    frame, t = mission.frames[first], mission.frames[first].t_gen
    told = OnAir(t, "r1", 20_000, digest=True)
    flight.on_air = [told, *flight.on_air]
    found = score(mission, flight, 0.0)
    assert (found.over, found.worst) == (1.0, pytest.approx((sum(sizes) + 20_000) / mission.limit))
    assert found.told == found.digests == pytest.approx(20_000 / 3.0)
    assert found.sent == sum(sizes)
    assert found.allowed == 2500.0
    flight.on_air[0] = OnAir(t - mission.window - 0.001, "r1", 20_000)
    assert score(mission, flight, 0.0).over == 0.0
    flight.on_air.append(OnAir(t + mission.window, "r0", frame.size, frame))
    assert score(mission, flight, 0.0).over == 0.5
    assert score(mission, flight, 0.0).digests == 0.0


def test_what_long_spans_hold_shows_what_is_exceeded_for_good(mission):
    """One limit in each window is all that is allowed, and shows as one; more shows as so much more."""
    every = [OnAir(WARM_UP + each * mission.window, "r0", int(mission.limit)) for each in range(60)]
    assert score(mission, Flight(on_air=every), 0.0).sustained == pytest.approx(1.0, rel=1e-4)
    twice = [replace(air, size=2 * air.size) if air.t > WARM_UP + 15.0 else air for air in every]
    assert score(mission, Flight(on_air=twice), 0.0).sustained == pytest.approx(2.0, rel=1e-4)
    before = [replace(air, t=air.t - WARM_UP - 30.0) for air in every]
    assert score(mission, Flight(on_air=before), 0.0).sustained == 0.0


def test_fill_is_what_was_sent_of_what_could_be(mission):
    """The limit's room, or the offer where that is less."""
    found = score(mission, flown(mission, due(mission)), 0.0)
    assert found.fill == pytest.approx(found.offered / found.room)
    assert found.offered > found.room
    few = draw("crowd", 1, 0, WARM_UP + 3.0, latency=LATENCY)
    few = replace(few, carried=50 * few.carried)
    assert score(few, flown(few, due(few)), 0.0).fill == pytest.approx(1.0)


def test_the_longest_silence_of_each_robot(mission):
    """Between two samples, from the warm-up on, and to the end."""
    first, last = (due(mission, "camera")[place] for place in (0, -1))
    robot = mission.frames[first].robot
    flight = flown(mission, [i for i in (first, last) if mission.frames[i].robot == robot])
    silence = score(mission, flight, 0.0).silence
    assert silence[robot] == pytest.approx(max(2.9, 0.0), abs=0.25)
    assert [silence[other] for other in mission.robots if other != robot] == [3.0]


def test_silence_is_told_of_each_robot_where_one_sends_for_all(mission):
    """Its samples are told by their keys."""
    every = due(mission, "odometry")
    by_one = alone(mission)
    found = [score(flown_by, flown(flown_by, every), 0.0).silence for flown_by in (mission, by_one)]
    assert found[0] == found[1]
    assert set(found[1]) == {"r0", "r1"}
