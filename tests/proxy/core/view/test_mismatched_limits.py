"""Robots with other limits, or that nobody understands: they hold up nobody, and everybody is told."""

import pytest

from planner import SearchSettings
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Notice
from proxy.core.model.limits import fingerprint
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.envelope import VERSION
from proxy.core.protocol.messages import Digest, State, tag
from proxy.core.view.tuning import TUNING
from studies.simulation.medium import Medium
from studies.simulation.team import Frame, Team
from tests.proxy.core.talk import SPEC
from utility_specs import Specs, load_specs

ALIEN = 12345
"""What tells other limits than ours."""


@pytest.fixture
def talk(make_talk):
    """A robot, and another one that takes part in the team."""
    talk = make_talk()
    talk.tell(ev.PeerAppeared(0.0, "op", "zz-op"))
    says(talk, 0.0)
    return talk


def says(talk, now):
    talk.tell(ev.DigestHeard(now, Digest("op", "zz-op", now, state=1)))


def has(talk, now, limits, number=1, specs="otherspecs"):
    """The other robot says what limits it has."""
    state = State("op", "zz-op", "enforce", specs, (), ("robot/*/camera",), number=number, limits=limits)
    talk.tell(ev.StateHeard(now, state))


def apart(talk):
    """Who takes no part."""
    return set(talk.core.mismatched.found)


def warnings(talk, now):
    return [text for text in talk.core.status(now)["warnings"] if "other limits" in text]


def test_a_robot_without_specs_is_called_so(talk):
    """Its generation, all zeros, would tell nobody anything."""
    has(talk, 1.0, ALIEN, specs=Specs.empty().generation)
    talk.tell(ev.TimePassed(2.0 + TUNING.agreement_time))
    (warning,) = warnings(talk, 2.0 + TUNING.agreement_time)
    assert warning.startswith("robot op has other limits (specs none, here ")


def test_who_has_other_limits_for_long_is_left_out_and_named(talk):
    """When it has ours it is one of the team again."""
    has(talk, 1.0, ALIEN)
    talk.tell(ev.TimePassed(1.0 + TUNING.agreement_time))
    assert not warnings(talk, 1.0 + TUNING.agreement_time)
    talk.tell(ev.TimePassed(2.0 + TUNING.agreement_time))
    (warning,) = warnings(talk, 2.0 + TUNING.agreement_time)
    assert warning.startswith("robot op has other limits (specs otherspecs, here ")
    assert [notice.text for notice in talk.all(Notice) if notice.level == "error"] == [warning]
    assert apart(talk) == {"zz-op"}
    has(talk, 21.0, fingerprint(talk.core.view.specs), number=2)
    says(talk, 21.1)
    assert not warnings(talk, 21.1)
    assert apart(talk) == set()


def test_several_with_the_same_limits_are_named_in_one_line(talk):
    """As all others are where the odd one out is this robot; of very many some are named."""
    for number in range(2, 13):
        name, zid = f"r{number}", f"yy{number:06}"
        talk.tell(ev.PeerAppeared(0.0, name, zid))
        talk.tell(ev.DigestHeard(0.1, Digest(name, zid, 0.1, state=1)))
        state = State(name, zid, "enforce", "otherspecs" if number < 12 else "third", (), number=1, limits=ALIEN)
        talk.tell(ev.StateHeard(0.2, state))
    talk.tell(ev.TimePassed(1.5))
    now = 3.0 + TUNING.agreement_time
    talk.tell(ev.TimePassed(now))
    several, one = warnings(talk, now)
    assert several.startswith("robot r2 has other limits (specs otherspecs, here ")
    assert several.endswith("(the same with r3, r4, r5, r6, r7, r8, r9, r10 and 1 more)")
    assert one.startswith("robot r12 has other limits (specs third, here ")
    assert [notice.text for notice in talk.all(Notice) if notice.level == "error"] == [several, one]


def test_a_large_team_has_longer_to_tell_that_its_specs_have_changed(talk):
    """All pay for that out of one allowance: each of forty robots took some others for apart for 20 s."""
    for number in range(2, 41):
        name, zid = f"r{number}", f"yy{number:06}"
        talk.tell(ev.PeerAppeared(0.0, name, zid))
        talk.tell(ev.DigestHeard(0.1, Digest(name, zid, 0.1, state=1)))
    has(talk, 1.0, ALIEN)
    for now in range(2, 32):
        talk.tell(ev.TimePassed(float(now)))
        assert not warnings(talk, float(now))
    assert apart(talk) == set()
    talk.tell(ev.TimePassed(37.0))
    assert warnings(talk, 37.0)
    assert apart(talk) == {"zz-op"}


def test_who_was_gone_for_a_moment_was_not_silent(talk):
    """Nobody has heard it since it is back, and nobody had to by then."""
    talk.tell(ev.TimePassed(1.0))
    talk.tell(ev.PeerGone(1.01, "op", "zz-op"))
    talk.tell(ev.PeerAppeared(1.02, "op", "zz-op"))
    talk.tell(ev.TimePassed(1.0 + 2 * TUNING.mismatch_check))
    assert apart(talk) == set()
    talk.tell(ev.TimePassed(10.0 + TUNING.agreement_time))
    assert apart(talk) == {"zz-op"}


@pytest.mark.parametrize("goes", [True, False], ids=["it goes", "it gets ours"])
def test_specs_that_change_on_one_robot_after_the_other_are_no_reason(talk, goes):
    """What it says meanwhile counts, and so does its going."""
    has(talk, 1.0, ALIEN)
    if goes:
        talk.tell(ev.PeerGone(2.0, "op", "zz-op"))
    else:
        has(talk, 2.0, fingerprint(talk.core.view.specs), number=2)
    talk.tell(ev.TimePassed(3.0 + TUNING.agreement_time))
    assert not warnings(talk, 3.0 + TUNING.agreement_time)
    assert not [notice for notice in talk.all(Notice) if notice.level == "error"]


def test_who_does_not_say_what_limits_it_has_has_ours(talk):
    """Other specs alone, as of weights, are no other limits."""
    has(talk, 1.0, 0)
    talk.tell(ev.TimePassed(30.0))
    assert not warnings(talk, 30.0)
    assert apart(talk) == set()


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
        settings=CoreSettings("", ""),
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


@pytest.mark.full
@pytest.mark.parametrize("wire", [0, VERSION + 2, VERSION - 2])
def test_a_robot_that_is_not_understood_is_no_veto(tmp_path, wire):
    """It says nothing, or speaks another version: the others deliver, and their operators know."""
    path = tmp_path / "specs.toml"
    path.write_text(SPEC.format(limit="60 kB/s", window=0.5))
    team = Team(
        load_specs(path),
        {"r1": (), "r2": (), "op": ("robot/*/camera",)},
        Medium(250_000.0),
        search=SearchSettings(search="best"),
        settings=CoreSettings("", ""),
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
    talk = make_talk()
    talk.tell(ev.PeerAppeared(0.0, "op", "zz-op"))
    talk.tell(ev.TimePassed(1.5 + TUNING.agreement_time))
    assert apart(talk) == {"zz-op"}
    assert [notice.level for notice in talk.all(Notice) if "nothing is heard" in notice.text] == ["error"]
    talk.tell(ev.SampleHeard(7.0, "robot/op/camera", 1000, "zz-op", None, None))
    assert [stream.robot for stream in talk.core.view.streams] == ["?zz-op"]
    says(talk, 8.0)
    assert apart(talk) == set()
    assert not talk.core.status(8.0)["warnings"]


def test_messages_of_another_version_in_the_name_of_one_that_is_understood_change_nothing(talk):
    """Nobody without TLS knows who speaks: a forger cannot exclude a robot."""
    says(talk, 1.0)
    talk.tell(ev.VersionHeard(2.0, "zz-op", VERSION + 9))
    talk.tell(ev.TimePassed(4.0 + TUNING.agreement_time))
    assert apart(talk) == set()
    assert not talk.core.status(4.0 + TUNING.agreement_time)["warnings"]


def test_whose_digests_are_rare_takes_part(make_talk):
    """That it is understood its state shows."""
    talk = make_talk()
    talk.tell(ev.PeerAppeared(0.0, "op", "zz-op"))
    has(talk, 0.0, 0)
    talk.tell(ev.TimePassed(TUNING.understood_for - 1.0))
    assert apart(talk) == set()
    talk.tell(ev.TimePassed(TUNING.understood_for + 1.0))
    assert apart(talk) == {"zz-op"}


def test_who_hangs_after_it_was_understood_is_left_out_in_the_end(talk):
    """Its token stands, but it says nothing for much longer than a robot of the slowest team would."""
    says(talk, 1.0)
    talk.tell(ev.TimePassed(TUNING.understood_for))
    assert apart(talk) == set()
    talk.tell(ev.TimePassed(TUNING.understood_for + 2.0))
    assert apart(talk) == {"zz-op"}


def test_status_tells_versions_and_other_versions_from_what_is_malformed(make_talk):
    """Of our own daemon and of the others, as far as they say."""
    talk = make_talk(version="1.2.3")
    talk.tell(ev.PeerAppeared(0.0, "op", "zz-op"))
    talk.tell(ev.VersionHeard(0.0, "zz-op", VERSION + 1))
    talk.tell(ev.StateHeard(0.0, State("op", "zz-op", "enforce", "s", number=1, version="1.3.0")))
    talk.tell(ev.MalformedHeard(0.1, "op", "digest:other version"))
    talk.tell(ev.MalformedHeard(0.1, "op", "digest:malformed"))
    status = talk.core.status(0.2)
    assert (status["version"], status["wire_version"]) == ("1.2.3", VERSION)
    assert [(peer["version"], peer["wire_version"]) for peer in status["peers"]] == [("1.3.0", VERSION + 1)]
    assert (status["malformed"], status["other_version"]) == (1, 1)
    assert status["other_version_age"] == pytest.approx(0.1)
    assert talk.core.gossip.states.state.version == "1.2.3"


def test_who_comes_to_a_team_that_is_there_takes_part_from_its_first_word_on(talk):
    """A token alone proves nothing; an operator is told no sooner than of one who begins."""
    now = 1.0 + TUNING.team_begins
    talk.tell(ev.PeerAppeared(now, "r9", "z-r9"))
    assert apart(talk) == {"z-r9"}
    assert not [text for text in talk.core.status(now + 1.0)["warnings"] if "r9" in text]
    talk.tell(ev.StateHeard(now + 1.0, State("r9", "z-r9", "enforce", "", number=1)))
    talk.tell(ev.TimePassed(now + 1.2))
    assert not apart(talk)


def test_who_said_nothing_makes_a_team_doubt_all_who_come_for_a_while(make_talk):
    """Tokens that come and go hold up a robot that was alone once."""
    talk = make_talk()
    talk.tell(ev.PeerGone(0.0, "op", "zz-op"))
    talk.tell(ev.PeerAppeared(0.1, "r8", "z-r8"))
    assert not apart(talk)
    talk.tell(ev.PeerGone(0.2, "r8", "z-r8"))
    talk.tell(ev.PeerAppeared(0.3, "r9", "z-r9"))
    assert apart(talk) == {"z-r9"}
