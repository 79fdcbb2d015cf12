"""A team of the daemon's cores on one simulated medium."""

from collections import Counter
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from planner import SearchSettings
from proxy.core.interface.events import ModeChanged, TimePassed
from proxy.core.model.mode import Mode
from proxy.core.model.settings import CoreSettings
from studies.simulation.agenda import Agenda
from studies.simulation.conditions import Conditions
from studies.simulation.flights import fly
from studies.simulation.medium import Medium
from studies.simulation.missions import draw, scenario
from studies.simulation.network import OverMedium
from studies.simulation.team import Frame, Team
from utility_specs import load_specs

pytestmark = pytest.mark.full

RATE = 100_000.0
WINDOW = 0.95
SPEC = f"""
[[constraint]]
kind = "throughput"
limit = "{RATE * 0.9 / 1000} kB/s"
window = {WINDOW}

[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
aggregation = "most_recent"
weight = 1.0
utility = {{ kind = "video" }}
scale = "1 + 10 * red"
features.red = {{ kind = "color_fraction", color = "red" }}
"""


POSE = """
[[information_type]]
name = "pose"
keys = ["robot/*/pose"]
aggregation = "most_recent"
weight = 3.0
utility = { kind = "video" }
"""


@pytest.fixture
def specs(tmp_path):
    path = tmp_path / "spec.toml"
    path.write_text(SPEC)
    return load_specs(path)


def scene(robots=4, seconds=12.0, rate=10.0, red=0.3, apart=0.023):
    """Frames of 10 kB, of one robot so much later than of another; r1 sees red from 4 to 8 s."""
    frames = [
        Frame(
            f"r{r}",
            f"robot/r{r}/camera",
            1.0 + apart * r + k / rate,
            9_000 + 300 * r,
            {"red": red if r == 1 and 4.0 <= 1.0 + k / rate < 8.0 else 0.0},
        )
        for r in range(1, robots + 1)
        for k in range(int(seconds * rate))
    ]
    return sorted(frames, key=lambda frame: frame.t_gen)


def team(specs, *, robots=4, wants=(), **changes):
    interests = {f"r{r}": wants for r in range(1, robots + 1)} | {"op": wants or ("robot/*/camera",)}
    medium = changes.pop("medium", Medium(RATE))
    return Team(specs, interests, medium, search=SearchSettings(search="best"), **changes)


def switch(flight, robot, mode, t):
    member = flight.members[robot]
    flight._feed(member, t, ModeChanged(member.now(t), mode))


def windows(deliveries):
    """The bytes sent by all robots within the closed window that ends with each sample."""
    sent = np.array([d.t_sent for d in deliveries])
    sizes = np.cumsum([0] + [d.frame.size for d in deliveries])
    return sizes[1:] - sizes[np.searchsorted(sent, sent - WINDOW, "left")]


@pytest.mark.parametrize(
    ("coordination", "loss"), [pytest.param("split", 0.0, marks=pytest.mark.full), ("split", 0.2), ("announce", 0.0)]
)
def test_the_union_of_all_robots_keeps_the_limit(specs, coordination, loss):
    """In `split` in every window, also when a fifth of all messages is lost; in `announce` once news have got through.

    All begin at once there, and know nothing of each other. Nothing goes uncounted.
    """
    flight = team(specs, medium=Medium(RATE, loss=loss), settings=CoreSettings("", "", coordination=coordination))
    deliveries = flight.run(scene(), 14.0)
    assert len(deliveries) > 50
    settled = [d for d in deliveries if coordination == "split" or d.t_sent > 3.0]
    over = windows(settled) - 0.9 * RATE * WINDOW
    # News wait behind frames on a channel that is as slow as the limit: now and then two take the same room.
    assert np.mean(over > 0.0) <= (0.1 if coordination == "announce" else 0.0)
    assert over.max() <= 2 * 10_200
    for core in flight.cores.values():
        assert core.counts.conserved
    assert sum(core.counts.received for core in flight.cores.values()) == len(scene())


@pytest.mark.parametrize(("carried", "times"), [(2.0, 2.0), (1.0, 1.5)], ids=["early news", "late news"])
def test_who_sees_red_sends_more_often(specs, carried, times):
    """The share follows the value within a second of its change, whoever's frames come when.

    On a channel that is as slow as the limit news wait behind frames: then the team has parts, which follow in slots.
    """
    flights = [
        team(specs, medium=Medium(carried * RATE)).run(scene(red=0.6, apart=apart), 14.0)
        for apart in (0.013, 0.017, 0.023)
    ]
    during = [d.frame for deliveries in flights for d in deliveries if 5.0 <= d.frame.t_gen < 8.0]
    red = sum(frame.robot == "r1" for frame in during)
    others = sum(frame.robot != "r1" for frame in during) / 3
    assert red >= times * others > 0


@pytest.mark.parametrize(
    ("coordination", "close"),
    [
        ("announce", 11),
        ("split", 11),
        pytest.param("announce", 1, marks=pytest.mark.full),
        pytest.param("split", 1, marks=pytest.mark.full),
    ],
)
def test_a_stream_that_begins_with_samples_close_together_is_sent(specs, coordination, close):
    """Of a publisher that catches up once it is connected, and whose samples are worth most, most are sent."""
    frames = scene(seconds=6.0)
    red = [replace(frame, features={"red": 0.6}) for frame in frames if frame.robot == "r1"]
    early = [replace(red[0], t_gen=red[0].t_gen - 0.001 * k) for k in range(close, 0, -1)]
    frames = sorted([*early, *red, *(f for f in frames if f.robot != "r1")], key=lambda frame: frame.t_gen)
    flight = team(specs, settings=CoreSettings("", "", coordination=coordination))
    sent = Counter(d.frame.robot for d in flight.run(frames, 8.0))
    assert sent["r1"] > 0.8 * max(sent[robot] for robot in ("r2", "r3", "r4"))


class OneWay(OverMedium):
    """Nothing that r3 sends comes to r4."""

    def send(self, t, size, sender, receivers, arrive, *, broadcast):
        heard = [receiver for receiver in receivers if (sender, receiver) != ("r3", "r4")]
        super().send(t, size, sender, heard, arrive, broadcast=broadcast)

    def reliable(self, t, size, sender, receiver, arrive):
        if (sender, receiver) != ("r3", "r4"):
            super().reliable(t, size, sender, receiver, arrive)


def test_a_robot_that_agrees_with_nobody_silences_nobody():
    """Ten robots have parts that hold no message until they agree on turns; one of them hears nothing of another."""
    how = Conditions(limit=5, seconds=20.0)
    mission = draw(scenario("mixed"), 0, how)
    medium, agenda = Medium(how.rate, how.latency), Agenda()
    search = SearchSettings(search="best")
    network = OneWay(medium, agenda)
    flight = Team(mission.specs, mission.interests, medium, search=search, network=network, agenda=agenda)
    flight.run(mission.frames, 30.0)
    sent = [air.t for air in flight.on_air if air.frame is not None and air.t >= 15.0]
    assert len(sent) > 0.4 * 15.0 / how.window * how.limit
    assert all(later - t >= how.window for t, later in zip(sent, sent[how.limit :], strict=False))


def test_digests_stay_within_their_allowance(specs):
    """Two percent of the limit for all robots together, or 100 B/s each."""
    flight = team(specs)
    flight.run(scene(), 14.0)
    assert flight.digest_bytes / 14.0 <= 1.1 * max(0.02 * 0.9 * RATE, 100.0 * 5)


def test_wrong_clocks_change_nothing(specs):
    """Robots whose clocks are minutes apart send as much in all, if not the same frames: these are worth the same."""
    right = team(specs).run(scene(), 14.0)
    wrong = team(specs, clocks={"r1": 600.0, "r2": -300.0, "op": 77.0}).run(scene(), 14.0)
    one, other = (Counter(d.frame.robot for d in deliveries) for deliveries in (right, wrong))
    assert other.total() == pytest.approx(one.total(), rel=0.1)


def test_a_robot_alone_uses_what_the_limit_gives(specs):
    """One robot and an operator: nearly all of the limit is used."""
    deliveries = team(specs, robots=1).run(scene(robots=1, rate=20.0, red=0.0), 14.0)
    sent = sum(d.frame.size for d in deliveries if 3.0 <= d.t_sent <= 13.0)
    assert sent >= 0.8 * 0.9 * RATE * 10.0


def test_in_announce_robots_plan_for_the_union(specs):
    """It may be exceeded for a moment, but digests keep the mean use below the limit."""
    flight = team(specs, settings=CoreSettings("", "", coordination="announce"))
    deliveries = flight.run(scene(), 14.0)
    sent = sum(d.frame.size for d in deliveries if 3.0 <= d.t_sent <= 13.0)
    assert 0.3 * 0.9 * RATE * 10.0 <= sent <= 1.05 * 0.9 * RATE * 10.0


def test_where_robots_broadcast_a_digest_follows_what_was_sent():
    """Most of the time at once, as far as the allowance goes: whoever lost the sample has it from there."""
    how = Conditions(coordination="announce", transport="broadcast", limit=2, seconds=10.0)
    flight = fly(draw(scenario("most"), 0, how), how, 0)
    digests = [(air.robot, air.t) for air in flight.on_air if air.digest]
    sends = [air for air in flight.on_air if air.frame is not None and 5.0 <= air.t < 19.0]
    told = [any(robot == air.robot and 0.0 <= t - air.t < 0.1 for robot, t in digests) for air in sends]
    assert sum(told) >= 0.7 * len(told) > 0
    for member in flight.members.values():
        now = member.now(20.0)
        member.core.handle(TimePassed(now))
        assert member.core.wake_at(now) > now


def test_nobody_is_woken_again_and_again_while_it_may_not_speak():
    """In a second a few dozen times, not as often as a machine can."""
    how = Conditions(transport="broadcast", seconds=0.5)
    flight = fly(draw(scenario("few"), 0, how), how, 0)
    for member in flight.members.values():
        now = begin = member.now(10.5)
        woken = 0
        while now < begin + 1.0 and woken < 1000:
            member.core.handle(TimePassed(now))
            now = max(member.core.wake_at(now), now + 1e-4)
            woken += 1
        assert 1 <= woken < 100


def test_a_robot_that_sends_everything_leaves_the_others_their_small_samples(tmp_path):
    """Twice the limit, which all hear: without the floor none of them sent one after the first seconds."""
    path = tmp_path / "spec.toml"
    path.write_text(SPEC + POSE)
    flight = team(load_specs(path), medium=Medium(100 * RATE), robots=4, wants=("robot/**",))
    flight.agenda.at(0.5, partial(switch, flight, "r1", Mode.SHADOW))
    large = [Frame("r1", "robot/r1/camera", 1.0 + 0.2 * k, 9_000, {"red": 0.0}) for k in range(60)]
    small = [
        Frame(f"r{r}", f"robot/r{r}/pose", 1.0 + 0.02 * r + 0.2 * k, 150, {}) for r in (2, 3, 4) for k in range(60)
    ]
    deliveries = flight.run(sorted(large + small, key=lambda frame: frame.t_gen), 14.0)
    sent = Counter((d.frame.robot, d.receiver) for d in deliveries if d.t_sent > 3.0)
    assert sent["r1", "op"] == 50
    assert min(sent[f"r{r}", "op"] for r in (2, 3, 4)) >= 40


def test_robots_split_constraints_of_all_kinds_at_once(tmp_path):
    """The union keeps bytes, messages and airtime in every window, each robot its own energy; and much is sent."""
    path = tmp_path / "spec.toml"
    path.write_text(
        SPEC
        + """
[[constraint]]
kind = "messages"
limit = 12
window = 1
[[constraint]]
kind = "airtime"
limit = "40 %"
rate = "2 Mbit/s"
[[constraint]]
kind = "energy"
limit = "60 mJ"
window = 1
per_byte = "1 uJ"
per_message = "1 mJ"
"""
    )
    specs = load_specs(path)
    flight = team(specs, robots=2, settings=CoreSettings("", "", coordination="split", allowance=0.1))
    deliveries = flight.run(scene(robots=2), 14.0)
    for measure in (spec.measure for spec in specs.constraints):
        robots = ["r1", "r2"] if measure.private else [""]
        for robot in robots:
            sent = [
                (d.t_sent, measure.use(d.frame.size, 1, own=True))
                for d in deliveries
                if d.frame.robot.startswith(robot)
            ]
            assert sent
            for end, _ in sent:
                assert sum(use for t, use in sent if end - measure.window <= t <= end) <= measure.limit * (1 + 1e-9)
    assert len([d for d in deliveries if 3.0 <= d.t_sent <= 13.0]) >= 24
