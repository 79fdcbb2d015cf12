"""Robots with other limits, or that nobody understands: they hold up nobody, and everybody is told."""

import pytest

from planner import SearchSettings
from proxy.core import events as ev
from proxy.core.codec import VERSION
from proxy.core.commands import Notice
from proxy.core.outsiders import PATIENCE, SILENCE
from proxy.core.settings import CoreSettings
from proxy.core.wire import Digest, State, tag
from studies.simulation.medium import Medium
from studies.simulation.team import Frame, Team
from tests.proxy.core.talk import SPEC
from utility_specs import load_specs

ALIEN = (3 << 32) | 12345
"""An epoch of other limits than ours."""


@pytest.fixture
def talk(make_talk):
    """A robot that shares, and another one that has other specs and says so."""
    talk = make_talk(coordination="split", settle=0.0)
    talk.tell(ev.PeerAppeared(0.0, "op", "zz-op"))
    talk.tell(ev.StateHeard(0.0, State("op", "zz-op", "enforce", "otherspecs", (), ("robot/*/camera",), number=1)))
    return talk


def says(talk, now, epoch):
    talk.tell(ev.DigestHeard(now, Digest("op", "zz-op", now, 0, 0, state=1)))


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
    talk = make_talk(coordination="split", settle=0.0)
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
        settings=CoreSettings("", "", coordination="split"),
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


GHOST = "0000000000ff"
"""A robot whose tag is the least."""


@pytest.mark.parametrize("wire", [0, VERSION + 2, VERSION - 2])
def test_a_robot_that_is_not_understood_is_no_veto(tmp_path, wire):
    """It would lead, but says nothing, or speaks another version: the others deliver, and their operators know."""
    path = tmp_path / "specs.toml"
    path.write_text(SPEC.format(limit="60 kB/s", window=0.5))
    team = Team(
        load_specs(path),
        {"r1": (), "r2": (), "op": ("robot/*/camera",)},
        Medium(250_000.0),
        search=SearchSettings(search="best"),
        settings=CoreSettings("", "", coordination="split"),
    )
    for core in team.cores.values():
        core.handle(ev.PeerAppeared(0.0, "ghost", GHOST))
        core.handle(ev.VersionHeard(0.0, tag(GHOST), wire))
    frames = [
        Frame(f"r{r}", f"robot/r{r}/camera", 1.0 + 0.01 * r + 0.2 * k, 3000, {"red": 0.0})
        for k in range(60)
        for r in (1, 2)
    ]
    heard = [d for d in team.run(frames, 14.0) if d.receiver == "op"]
    assert len([d for d in heard if d.frame.t_gen > 8.0]) > 40
    said = "another version of Sendworthy" if wire else "nothing is heard of it"
    for core in team.cores.values():
        (warning,) = core.status(14.0)["warnings"]
        assert warning.startswith("robot ghost ")
        assert said in warning
        ghost = next(peer for peer in core.status(14.0)["peers"] if peer["robot"] == "ghost")
        assert (ghost["takes_part"], ghost["wire_version"]) == (False, wire or None)


def test_who_says_something_in_the_end_takes_part(make_talk):
    """It was slow to start: from its first digest it is one of the team, and no plain node any more."""
    talk = make_talk(coordination="split", settle=0.0)
    talk.tell(ev.PeerAppeared(0.0, "op", "zz-op"))
    talk.tell(ev.TimePassed(1.5 + PATIENCE))
    assert talk.core.shares.members == {talk.core.shares.own}
    assert [notice.level for notice in talk.all(Notice) if "nothing is heard" in notice.text] == ["error"]
    talk.tell(ev.SampleHeard(7.0, "robot/op/camera", 1000, "zz-op", None, None))
    assert [stream.robot for stream in talk.core.view.streams()] == ["?zz-op"]
    says(talk, 8.0, 0)
    assert "zz-op" in talk.core.shares.members
    assert not talk.core.status(8.0)["warnings"]


def test_messages_of_another_version_in_the_name_of_one_that_is_understood_change_nothing(talk):
    """Nobody without TLS knows who speaks: a forger cannot exclude a robot."""
    says(talk, 1.0, 0)
    talk.tell(ev.VersionHeard(2.0, "zz-op", VERSION + 9))
    talk.tell(ev.TimePassed(4.0 + PATIENCE))
    assert "zz-op" in talk.core.shares.members
    assert not talk.core.status(4.0 + PATIENCE)["warnings"]


def test_who_speaks_to_another_robot_alone_takes_part(talk):
    """A robot that follows tells all something every minute or two; that it is understood its state shows."""
    talk.tell(ev.TimePassed(SILENCE - 1.0))
    assert "zz-op" in talk.core.shares.members
    talk.tell(ev.TimePassed(SILENCE + 1.0))
    assert "zz-op" not in talk.core.shares.members


def test_who_hangs_after_it_was_understood_is_left_out_in_the_end(talk):
    """Its token stands, but it says nothing for much longer than a robot of the slowest team would."""
    says(talk, 1.0, 0)
    talk.tell(ev.TimePassed(SILENCE))
    assert "zz-op" in talk.core.shares.members
    talk.tell(ev.TimePassed(SILENCE + 2.0))
    assert "zz-op" not in talk.core.shares.members


def test_status_tells_versions_and_other_versions_from_what_is_malformed(make_talk):
    """Of our own daemon and of the others, as far as they say."""
    talk = make_talk(coordination="split", version="1.2.3")
    talk.tell(ev.PeerAppeared(0.0, "op", "zz-op"))
    talk.tell(ev.VersionHeard(0.0, "zz-op", VERSION + 1))
    talk.tell(ev.StateHeard(0.0, State("op", "zz-op", "enforce", "s", number=1, version="1.3.0")))
    talk.tell(ev.MalformedHeard(0.1, "op", "digest:other version"))
    talk.tell(ev.MalformedHeard(0.1, "op", "digest:malformed"))
    status = talk.core.status(0.2)
    assert (status["version"], status["wire_version"]) == ("1.2.3", VERSION)
    assert [(peer["version"], peer["wire_version"]) for peer in status["peers"]] == [("1.3.0", VERSION + 1)]
    assert (status["malformed"], status["other_version"]) == (1, 1)
    assert talk.core.telling.state.version == "1.2.3"
