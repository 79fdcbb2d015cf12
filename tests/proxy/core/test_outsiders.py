"""Robots with other limits: they hold up nobody, and everybody is told."""

import pytest

from planner import SearchSettings
from proxy.core import events as ev
from proxy.core.commands import Notice
from proxy.core.outsiders import PATIENCE
from proxy.core.settings import CoreSettings
from proxy.core.wire import Digest, State
from studies.simulation.medium import Medium
from studies.simulation.team import Frame, Team
from tests.proxy.core.talk import SPEC
from utility_specs import load_specs

ALIEN = (3 << 32) | 12345
"""An epoch of other limits than ours."""


@pytest.fixture
def talk(make_talk):
    """A robot that shares, and another one that has other specs and says so."""
    talk = make_talk(coordination="shares", settle=0.0)
    talk.tell(ev.PeerAppeared(0.0, "op", "zz-op"))
    talk.tell(ev.StateHeard(0.0, State("op", "zz-op", "enforce", "otherspecs", (), ("robot/*/camera",), number=1)))
    return talk


def says(talk, now, epoch):
    talk.tell(ev.DigestHeard(now, Digest("op", "zz-op", now, epoch, 0, 0, state=1)))


def warnings(talk, now):
    return [text for text in talk.core.status(now)["warnings"] if "other limits" in text]


def test_who_has_other_limits_for_long_is_left_out_and_named(talk):
    """Nobody waits for it any more; when it has ours it is shared with again."""
    says(talk, 1.0, ALIEN)
    assert talk.core.shares.stragglers == ["zz-op"]
    talk.tell(ev.TimePassed(1.0 + PATIENCE))
    assert not warnings(talk, 1.0 + PATIENCE)
    talk.tell(ev.TimePassed(1.1 + PATIENCE))
    (warning,) = warnings(talk, 1.1 + PATIENCE)
    assert warning.startswith("robot op has other limits (specs otherspecs, here ")
    assert [notice.text for notice in talk.all(Notice) if notice.level == "error"] == [warning]
    assert talk.core.shares.members == {talk.core.shares.own}
    talk.tell(ev.TimePassed(20.0))
    assert talk.core.shares.confirmed(20.0)
    says(talk, 21.0, 0)
    assert not warnings(talk, 21.0)
    assert talk.core.shares.members == {talk.core.shares.own, "zz-op"}


def test_specs_that_change_on_one_robot_after_the_other_are_no_reason(talk):
    """What it says meanwhile counts, and so does its going."""
    says(talk, 1.0, ALIEN)
    says(talk, 2.0, talk.core.shares.epoch)
    talk.tell(ev.TimePassed(3.0 + PATIENCE))
    assert not warnings(talk, 3.0 + PATIENCE)
    says(talk, 11.0, ALIEN)
    talk.tell(ev.PeerGone(12.0, "op", "zz-op"))
    talk.tell(ev.TimePassed(13.0 + PATIENCE))
    assert not warnings(talk, 13.0 + PATIENCE)


@pytest.mark.parametrize("late", [1.0, PATIENCE + 1.0], ids=["in time", "named already"])
def test_who_got_our_specs_has_no_other_limits_although_it_said_nothing_since(talk, late):
    """Digests are rare; what a robot said of its epoch before it had our specs counts no more."""
    says(talk, 1.0, ALIEN)
    talk.tell(ev.TimePassed(1.0 + late))
    ours = talk.core.view.specs.generation
    talk.tell(ev.StateHeard(1.1 + late, State("op", "zz-op", "enforce", ours, (), ("robot/*/camera",), number=2)))
    before = len(talk.all(Notice))
    talk.tell(ev.TimePassed(2.0 + late + PATIENCE))
    assert not warnings(talk, 2.0 + late + PATIENCE)
    assert not [notice for notice in talk.all(Notice)[before:] if notice.level == "error"]


def test_who_follows_somebody_that_we_do_not_know_is_waited_for(make_talk):
    """With the same specs another epoch is no sign of other limits."""
    talk = make_talk(coordination="shares", settle=0.0)
    talk.tell(ev.PeerAppeared(0.0, "op", "zz-op"))
    generation = talk.core.view.specs.generation
    talk.tell(ev.StateHeard(0.0, State("op", "zz-op", "enforce", generation, (), ("robot/*/camera",), number=1)))
    says(talk, 1.0, ALIEN)
    talk.tell(ev.TimePassed(30.0))
    assert "zz-op" in talk.core.shares.members
    assert not warnings(talk, 30.0)


def test_a_team_with_different_limits_still_sends(tmp_path):
    """Each robot keeps its own, as if it were alone with those that have the same."""
    teams = []
    for limit in ("40 kB/s", "60 kB/s"):
        path = tmp_path / "specs.toml"
        path.write_text(SPEC.format(limit=limit, window=0.5))
        teams.append(load_specs(path))
    team = Team(
        teams[0],
        {"r1": (), "r2": (), "op": ("robot/*/camera",)},
        Medium(250_000.0),
        search=SearchSettings(search="best"),
        settings=CoreSettings("", "", coordination="shares"),
    )
    core = team.cores["op"]
    core.handle(ev.SpecsChanged(0.0, teams[1]))
    frames = [
        Frame(f"r{r}", f"robot/r{r}/camera", 1.0 + 0.01 * r + 0.2 * k, 3000, {"red": 0.0})
        for k in range(80)
        for r in (1, 2)
    ]
    heard = [d for d in team.run(frames, 18.0) if d.receiver == "op"]
    assert len([d for d in heard if d.frame.t_gen > 9.0]) > 40
    assert any("other limits" in text for text in team.cores["r1"].status(18.0)["warnings"])
