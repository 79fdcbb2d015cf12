"""Which messages are expected, of whom since when, and how far ahead."""

import itertools
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from planner import SearchSettings, start
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Drop, Forward
from proxy.core.model.settings import CoreSettings, broadcast
from proxy.core.protocol.messages import State
from proxy.core.view.stream import Generated, Sent
from proxy.core.window.forecast import guaranteed, longest, owed
from proxy.core.window.tuning import TUNING
from proxy.core.window.window import WindowBuilder
from studies.simulation.medium import Medium
from studies.simulation.team import Frame, Team
from tests.proxy.core.window.views import (
    add_stream,
    make_view,
    sample,
    union,
)
from utility_specs import load_specs


def test_others_messages_that_would_have_been_announced_are_decisions_only_as_long_as_that_takes(make_specs):
    """The latency, its margin, and what the stream is late by now and then; what was not announced was not sent."""
    view = make_view(make_specs())
    view.subscribers.set_own(("robot/**",))
    add_stream(view, "r1")
    late = TUNING.overheard_within + add_stream(view, "r2").schedule.jitter

    def past(now):
        problem = WindowBuilder(view, 0.0).build(now, sample(now), (), union())[0]
        return [(m.stream, m.t_gen) for m in problem.messages if m.t_gen < now]

    assert past(10.5 + 0.9 * late) == [(1, pytest.approx(10.5))]
    assert past(10.5 + 1.1 * late) == []


def test_what_a_lesser_claim_may_have_had_sent_is_no_decision(make_specs):
    """It gives way to us: where all took each other's samples for sent nobody would send any.

    Where all plans say the same they say that nobody gives way.
    """
    view = make_view(make_specs())
    view.subscribers.set_own(("robot/**",))
    ours, other = add_stream(view, "r1"), add_stream(view, "r2")

    def past(now, *, agreed=False):
        limits = replace(union(), agreed=agreed)
        problem = WindowBuilder(view, 0.0).build(now, sample(now), (), limits)[0]
        return [m.t_gen for m in problem.messages if m.t_gen < now and not m.sent]

    view.traffic.note_sent(ours, 1, Sent(9.5, 9.5, 1000, 1.0))
    view.traffic.note_sent(other, 1, Sent(9.0, 9.0, 1000, 1.0))
    assert past(10.505) == [pytest.approx(10.5)]
    view.traffic.note_sent(other, 2, Sent(9.6, 9.6, 1000, 1.0))
    assert past(10.505) == []
    assert past(10.505, agreed=True) == [pytest.approx(10.5)]


def test_who_overhears_takes_what_was_not_heard_in_time_for_not_sent(make_specs):
    """In time is the latency, its margin, and what the stream is late by now and then."""
    group = broadcast("224.0.0.226:7449")
    view = make_view(make_specs(), transport=group)
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", (), ("robot/**",), transport=group))
    add_stream(view, "r1")
    other = add_stream(view, "r2")
    view.subscribers.set_own(("robot/**",))
    late = TUNING.overheard_within + other.schedule.jitter

    def past(now):
        problem = WindowBuilder(view, 0.0).build(now, sample(now), (), union())[0]
        return [m.t_gen for m in problem.messages if m.t_gen < now]

    assert past(10.5 + 0.9 * late) == [pytest.approx(10.5)]
    assert past(10.5 + 1.1 * late) == []


TRENDING = """
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
utility = { kind = "linear", slope = 0.1 }
scale = "10 * red"
features.red = { kind = "color_fraction", color = "red" }
forecast = { features = { red = "trend" } }
"""


def test_what_is_forecast_is_worth_what_its_features_will_be(make_specs):
    """Of our own streams by features, of others' by the scale that they tell."""
    view = make_view(make_specs(text=TRENDING))
    view.subscribers.set_own(("robot/**",))
    for robot in ("r1", "r2"):
        stream = view.streams.touch(10.0, robot, f"robot/{robot}/camera")
        stream.matching = True
        for count in range(11):
            features = {"red": 0.01 * count} if robot == "r1" else {}
            stream.note_generated(count + 1, Generated(float(count), 1000, 0.1 * count, features))
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), union())[0]
    ours = [(m.t_gen, m.scale) for m in problem.messages if m.stream == 0][1:3]
    others = [(m.t_gen, m.scale) for m in problem.messages if m.stream == 1][:2]
    assert np.array(ours) == pytest.approx(np.array([(11.0, 1.1), (12.0, 1.4)]))
    assert np.array(others) == pytest.approx(np.array(ours))


def test_others_random_samples_are_expected_from_now_on(make_specs):
    """As nothing was heard of any since, there was none."""
    spec = TRENDING.replace('features = { red = "trend" }', 'schedule = { kind = "poisson", interval = 3 }')
    view = make_view(make_specs(text=spec))
    view.subscribers.set_own(("robot/**",))
    for robot in ("r1", "r2"):
        add_stream(view, robot, size=3000)
    problem = WindowBuilder(view, 0.0).build(12.5, sample(12.5), (), union())[0]
    assert [m.t_gen for m in problem.messages if m.stream == 1] == [15.5]


def offered(make_specs, sizes, *, robots=4, kind="", scales=(1.0,), alone=False):
    """Robots with frames of 10 Hz of these sizes, and worths, in turn, under a limit of 4 kB/s; what is expected."""
    view = make_view(make_specs(), horizon=400)
    for robot in range(robots):
        stream = view.streams.touch(10.0, f"r{robot + 1}", f"robot/r{robot + 1}/camera")
        stream.matching = True
        for count in range(100):
            stream.note_generated(
                count + 1, Generated(0.1 * count + 0.02 * robot, sizes[count % len(sizes)], scales[robot % len(scales)])
            )
        if kind:
            stream.schedule.assume(0.1, kind)
    problem = WindowBuilder(view, 0.0).build(10.0, sample(10.0), [], replace(union(), alone=alone))[0]
    return [m for m in problem.messages if not m.sent and m.t_gen > 10.0]


def test_where_far_more_is_offered_than_fits_only_the_smallest_samples_are_expected_to_be_sent(make_specs):
    """So few as are needed to use the limit up, and as small: no frame of usual size takes the room of two of them."""
    messages = offered(make_specs, (1800, 2000, 2200))
    carried = 4_000.0 / (4 * 10 * 2_000.0)
    until = max(m.t_gen for m in messages)
    assert len(messages) == pytest.approx(TUNING.offered * carried * 40 * (until - 10.0), rel=0.2)
    assert [m.use[0] for m in messages] == pytest.approx([1690.0] * len(messages), abs=30.0)


@pytest.mark.parametrize(
    ("sizes", "robots", "kind"),
    [((2000,), 4, ""), ((180, 200, 220), 4, ""), ((900, 1000, 1100), 1, ""), ((1800, 2000, 2200), 4, "poisson")],
    ids=["alike", "small", "few", "at random"],
)
def test_else_all_samples_are(make_specs, sizes, robots, kind):
    """Where sizes are alike, or small beside the limit, or where most of them fit, nothing is gained by waiting."""
    messages = offered(make_specs, sizes, robots=robots, kind=kind)
    assert len(messages) >= 0.9 * robots * 10 * (max(m.t_gen for m in messages) - 10.0) - robots


def test_within_a_part_of_our_own_all_samples_are_expected(make_specs):
    """Where a later one was expected each time, small samples took the room of the one that came."""
    few, every = (offered(make_specs, (1800, 2000, 2200), robots=1, alone=alone) for alone in (False, True))
    assert len(few) < 0.5 * len(every)
    assert [m.t_gen - 10.0 for m in every] == pytest.approx([0.1 * (n + 1) for n in range(len(every))], abs=0.01)


def test_samples_of_little_worth_do_not_count_where_better_ones_are_chosen(make_specs):
    """A part of the better ones fit; were all four streams alike, as few of each would be expected."""
    count = Counter(m.stream for m in offered(make_specs, (1350, 1500, 1650), scales=(1.0, 0.1, 0.1, 0.1)))
    best, *others = sorted(count.values(), reverse=True)
    assert best >= 2 * max(others)


SPEC = """
[[constraint]]
kind = "throughput"
limit = "{limit} kB/s"
window = 1.0
[[information_type]]
name = "poor"
keys = ["robot/*/poor"]
weight = 0.001
{guarantee}
utility = {{ kind = "linear", slope = 0.1 }}
[[information_type]]
name = "rich"
keys = ["robot/*/rich"]
weight = 1000.0
utility = {{ kind = "linear", slope = 0.1 }}
"""


@pytest.fixture
def specs_of(tmp_path):
    """Specs of a stream that is worth next to nothing, with or without a guarantee, and one that is worth a lot."""

    def specs(guarantee, limit=4.2):
        path = tmp_path / "specs.toml"
        path.write_text(SPEC.format(guarantee=guarantee, limit=limit))
        return load_specs(path)

    return specs


def published(talk, until, kinds):
    """Publish streams of 4 Hz at one robot, decide all there is to decide; return when what of them was forwarded."""
    forwarded, samples = {kind: [] for kind in kinds}, {}
    for k in range(int(until * 4)):
        for place, kind in enumerate(kinds):
            t = 0.25 * k + 0.01 * place
            sample, commands = talk.publish(t, key=f"robot/r1/{kind}")
            samples[sample] = kind, t
            todo = list(commands)
            while todo:
                command = todo.pop(0)
                if isinstance(command, Decide):
                    search = start(command.problem, SearchSettings(), command.seed)
                    search.run(command.iterations)
                    todo += talk.tell(ev.DecisionReady(t, command.ticket, search.plan()))
                elif isinstance(command, Forward):
                    name, when = samples[command.sample]
                    forwarded[name].append(when)
    return forwarded


def gaps(times):
    return [b - a for a, b in itertools.pairwise(times)]


@pytest.mark.full
@pytest.mark.parametrize(
    ("guarantee", "most"), [('min_rate = "0.5 Hz"', 2.0), ('max_age = "1500 ms"', 1.5), ('min_rate = "1 Hz"', 1.0)]
)
@pytest.mark.parametrize("coordination", ["announce", "split"])
def test_a_guarantee_wins_over_worth(make_talk, specs_of, guarantee, most, coordination):
    """The poor stream is sent as often as is guaranteed; nearly all else goes to the rich one, within the limit."""
    talk = make_talk(specs_of(guarantee), coordination=coordination, settle=0.0, floor=0.0)
    for kind in ("poor", "rich"):
        talk.tell(ev.MatchingChanged(0.0, f"robot/r1/{kind}", matching=True))
    sent = published(talk, 20.0, ("poor", "rich"))
    assert max(gaps([t for t in sent["poor"] if t > 3.0])) <= most + 1e-6
    assert len(sent["rich"]) >= 2 * len(sent["poor"])
    every = np.sort([*sent["poor"], *sent["rich"]])
    assert all(np.count_nonzero((every >= t - 1.0 + 1e-9) & (every <= t)) <= 4 for t in every)
    decisions = talk.core.status(20.0)["decisions"]
    assert decisions["owed"] >= 5
    assert decisions["unkept"] == 0


def test_without_a_guarantee_the_poor_get_nothing(make_talk, specs_of):
    """So it is the guarantee that does it."""
    talk = make_talk(specs_of("", limit=3.2), settle=0.0)
    for kind in ("poor", "rich"):
        talk.tell(ev.MatchingChanged(0.0, f"robot/r1/{kind}", matching=True))
    sent = published(talk, 20.0, ("poor", "rich"))
    assert max(gaps([t for t in sent["poor"] if t > 3.0] + [20.0]), default=20.0) > 3.0
    assert talk.core.status(20.0)["decisions"]["owed"] == 0


def test_what_is_owed_is_counted_where_nothing_limits_it(make_talk, make_specs):
    """Each sample of a stream that generates fewer than are guaranteed, though there is room for all."""
    text = SPEC[SPEC.index("[[information_type]]") :].format(guarantee='min_rate = "8 Hz"')
    talk = make_talk(make_specs(text=text))
    talk.tell(ev.MatchingChanged(0.0, "robot/r1/poor", matching=True))
    sent = published(talk, 10.0, ("poor",))
    assert len(sent["poor"]) == 40
    assert talk.core.status(10.0)["decisions"]["owed"] >= 30


def test_what_the_limits_leave_no_room_for_is_counted(make_talk, specs_of):
    """A guarantee of more than the limit allows is kept as far as it goes."""
    talk = make_talk(specs_of('min_rate = "4 Hz"', limit=2.2))
    talk.tell(ev.MatchingChanged(0.0, "robot/r1/poor", matching=True))
    sent = published(talk, 10.0, ("poor",))
    assert 15 <= len(sent["poor"]) <= 21
    decisions = talk.core.status(10.0)["decisions"]
    assert len(sent["poor"]) - 2 <= decisions["owed"] <= len(sent["poor"])
    assert 15 <= decisions["unkept"] <= len(talk.all(Drop))


def test_what_is_owed_is_what_cannot_wait(make_talk, specs_of):
    """One sample may be left out where the next one is soon enough; what was never sent is owed at once."""
    talk = make_talk(specs_of('min_rate = "0.5 Hz"\nmax_age = "1 min"'))
    talk.tell(ev.MatchingChanged(0.0, "robot/r1/poor", matching=True))
    talk.publish(0.0, key="robot/r1/rich")
    for k in range(12):
        talk.publish(float(k), key="robot/r1/poor")
    poor, rich = (talk.core.view.streams.known("r1", f"robot/r1/{kind}") for kind in ("poor", "rich"))
    assert guaranteed(poor)
    assert not guaranteed(rich)
    assert (longest(poor, 1.0), longest(poor, 59.0)) == (2.0, 1.0)
    assert list(owed(rich, [12.0, 50.0], 0.0)) == []
    times = [11.0 + k for k in range(1, 8)]
    poor.sent = Sent(11.0, 11.0, 1000, 0.001)
    assert list(owed(poor, times, 0.0)) == [13.0, 15.0, 17.0]
    assert list(owed(poor, times, 59.0)) == times
    poor.sent = None
    assert list(owed(poor, times, 0.0)) == [12.0, 14.0, 16.0, 18.0]


def test_robots_of_a_team_are_lent_what_is_guaranteed(specs_of):
    """Who leads lends for it whatever it is worth, and the union keeps the limit."""
    specs = specs_of('min_rate = "0.5 Hz"', limit=8)
    team = Team(
        specs,
        {"r1": (), "r2": (), "r3": (), "op": ("robot/**",)},
        Medium(100_000.0),
        search=SearchSettings(search="best"),
        settings=CoreSettings("", "", coordination="split", allowance=0.5),
    )
    frames = sorted(
        (
            Frame(f"r{r}", f"robot/r{r}/{kind}", 1.0 + 0.03 * r + 0.01 * place + k / rate, 1000, {})
            for r in (1, 2, 3)
            for place, (kind, rate) in enumerate((("poor", 1.0), ("rich", 2.0)))
            for k in range(int(24 * rate))
        ),
        key=lambda frame: frame.t_gen,
    )
    heard = [d for d in team.run(frames, 26.0) if d.receiver == "op"]
    for r in (1, 2, 3):
        poor = [d.frame.t_gen for d in heard if d.frame.key == f"robot/r{r}/poor" and d.frame.t_gen > 6.0]
        assert max(gaps([6.0, *poor, 25.0])) <= 4.0
        assert len(poor) >= 7
    sent = np.sort([d.t_sent for d in heard])
    assert all(np.count_nonzero((sent >= t - 1.0 + 1e-9) & (sent <= t)) <= 8 for t in sent)
