"""What specs guarantee goes first, as far as the limits allow."""

import itertools

import numpy as np
import pytest

from planner import SearchSettings, start
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Drop, Forward
from proxy.core.model.settings import CoreSettings
from proxy.core.view.stream import Sent
from proxy.core.window.forecast import guaranteed, longest, owed
from studies.simulation.medium import Medium
from studies.simulation.team import Frame, Team
from utility_specs import load_specs

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
