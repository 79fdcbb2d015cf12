"""Who plans for whom: every robot for all, or each for itself with its part of every limit."""

import math
from dataclasses import replace

import numpy as np
import pytest

from proxy.core.coordination.equal_parts import NOT_NEEDED, NOT_NOW
from proxy.core.coordination.tuning import TUNING
from proxy.core.interface import events as ev
from proxy.core.protocol.bid import Segment
from proxy.core.protocol.messages import Digest, State, StreamDigest, StreamState
from proxy.core.protocol.split_report import SplitReport
from proxy.core.view.stream import Generated
from studies.simulation.traffic.comparison import Cell, how_of
from studies.simulation.traffic.flights import crew
from tests.proxy.core.coordination.conftest import WINDOW, Robot, names

CAMERA = (StreamState(1, "robot/op/camera", "camera", 0.5),)


def test_each_plans_for_all_while_news_are_early_and_announcements_affordable(make_team):
    """All of every limit is what all have together."""
    team = make_team()
    assert not team.look(waiting=0.9 * TUNING.late_news * WINDOW, announcing=TUNING.affordable)
    assert not team.coordination.team.splits
    assert team.coordination.part(team.now, 0) == 1.0
    assert team.coordination.turn(team.now, 0, team.limits[0], 9.0 * team.limits[0].limit) == NOT_NEEDED


def test_it_is_looked_at_now_and_then(make_team):
    """No more often, and for nothing that did not happen: time alone changes nothing where all plan for all."""
    team = make_team()
    team.look()
    assert team.coordination.due_at(team.now) > 1e9
    team.coordination.advance(
        team.now + 0.5 * TUNING.interval, team.limits, 99.0, lambda _: 99.0, lambda _: 0.0, passes_at=lambda now: now
    )
    assert not team.coordination.team.votes_to_split
    alone = make_team(())
    assert not alone.look(waiting=99.0, announcing=99.0)


def test_a_robot_without_shared_limits_never_splits(make_specs):
    """There is nothing to have a part of."""
    text = '[[information_type]]\nname = "camera"\nkeys = ["robot/*/camera"]\nutility = { kind = "video" }\n'
    team = Robot(make_specs(text=text))
    assert not team.look(waiting=99.0, announcing=99.0)
    assert not team.coordination.team.splits


def test_status_says_how_robots_keep_the_limit(make_talk):
    """As it is at the moment, not as it is configured."""
    talk = make_talk(allowance=0.2)
    talk.want(0.0)
    talk.tell(ev.StateHeard(0.0, State("op", "zz-op", "enforce", "", CAMERA, ("robot/*/camera",), number=2)))
    talk.tell(ev.InterestChanged(0.0, ("robot/op/camera",)))
    for k in range(20):
        now = 0.1 + 0.5 * k
        talk.publish(now, size=100)
        news = StreamDigest(1, k + 1, 0, now, 0.0, 100, 1.0)
        talk.tell(ev.DigestHeard(now + 0.01, Digest("op", "zz-op", now, streams=(news,), state=2)))
    assert talk.core.status(now)["coordination"] == "announce"
    talk.tell(ev.DigestHeard(now + 0.1, Digest("op", "zz-op", now + 0.1, splits=True, state=2)))
    status = talk.core.status(now + 0.1)
    assert status["coordination"] == "split"
    assert status["budget"][0]["held"] < status["budget"][0]["limit"]


def test_until_parts_are_agreed_on_a_team_that_changes_over_has_equal_ones_or_those_of_its_tables(make_team):
    """So the union holds with those who have agreed already: who gives uses less from the moment it says so."""
    team = make_team(("p1",))
    team.look(waiting=99.0)
    equal = (1.0 - team.view.settings.floor) / 2.0
    assert team.coordination.part(team.now, 0) == pytest.approx(equal)
    assert team.coordination.forming(team.now)
    bid = (Segment(9_000, 250),)
    team.say("p1", splits=True, split=SplitReport(1, bid, 1, 0))
    assert team.coordination.part(team.now, 0) == pytest.approx(equal)
    ours = team.coordination.announcement(team.now)
    team.coordination.announced(team.now, ours)
    assert team.coordination.part(team.now, 0) < 0.5 * equal
    team.say("p1", splits=True, split=SplitReport(1, None, ours.table, 0))
    team.look(waiting=99.0)
    assert team.coordination.split_in_force.agreement.formed
    assert not team.coordination.forming(team.now)
    assert 0.0 < team.coordination.part(team.now, 0) < 0.5 * equal


def agreed(make_team, asked=4_000):
    """A team of two that has agreed on parts, the other of which `asked` for so much, and what we announced."""
    team = make_team(("p1",))
    team.look(waiting=99.0)
    team.say("p1", splits=True, split=SplitReport(1, (Segment(asked, 100),), 1, 0))
    team.coordination.announced(team.now, ours := team.coordination.announcement(team.now))
    team.say("p1", splits=True, split=SplitReport(1, None, ours.table, 0))
    return team, ours


def test_who_overbooks_its_part_does_not_have_a_limit_to_itself(make_team):
    """What is larger than all of it would take the other's part, too."""
    team, _ = agreed(make_team, asked=200)
    for _ in range(200):
        team.go_on()
        team.look(waiting=99.0, announcing=2.0, using=0.1)
    limit = team.limits[0]
    assert TUNING.whole_part < team.coordination.part(team.now, 0) <= 1.0
    assert team.coordination.turn(team.now, 0, limit, 2.0 * limit.limit) == NOT_NOW


def test_a_team_whose_limits_change_has_equal_parts_until_it_agrees_anew(make_team):
    """Not what a first table gives it that says nothing of what it asks for, for as long as the longest window."""
    team, _ = agreed(make_team)
    for _ in range(round(1.5 * WINDOW / TUNING.interval)):
        team.look(waiting=99.0)
    assert team.coordination.formation.established
    team.limits = (*team.limits, replace(team.limits[0], name="long", window=10.0))
    team.coordination.set_limits(team.now, team.limits)
    team.coordination.advance(team.now, team.limits, 99.0, lambda _: 0.0, lambda _: 0.0, passes_at=lambda now: now)
    assert team.coordination.announcement(team.now).bid
    equal = (1.0 - team.view.settings.floor) / 2.0
    assert [team.coordination.part(team.now, k) for k in range(2)] == pytest.approx([equal, equal])


def test_who_cannot_tell_another_bid_yet_asks_for_nothing_else(make_team):
    """Its table would be pending until it can, and the others would bid before they hear of it."""
    team, ours = agreed(make_team)
    agreement = team.coordination.split_in_force.agreement
    assert agreement.formed
    assert not agreement.pending
    for count in range(40):
        for stream in team.view.streams.own():
            stream.note_generated(stream.generated + 1, Generated(team.now, 50_000, 50.0))
        team.look(waiting=99.0, words=5.0 if count < 39 else 0.0)
        assert agreement.bid[0] == ours.version or count == 39
    assert agreement.bid[0] > ours.version


def test_parts_are_agreed_on_by_states_as_by_digests(make_team):
    """In any order; a vote counts that comes with news, not one of the time when a whole state was told."""
    team = make_team(("p1",))
    team.look()
    state = State("p1", "p1", "enforce", "", splits=True, split=SplitReport(1, (Segment(9_000, 250),), 1, 0), number=3)
    team.coordination.heard(team.now, state)
    assert not team.coordination.team.splits
    team.coordination.heard(team.now, replace(state, since=3))
    team.look()
    assert team.coordination.team.splits
    ours = team.coordination.announcement(team.now)
    team.coordination.announced(team.now, ours)
    team.coordination.heard(team.now, replace(state, since=3, split=SplitReport(1, None, ours.table, ours.table)))
    team.coordination.heard(team.now, replace(state, since=3))
    team.look()
    assert team.coordination.split_in_force.agreement.formed
    assert team.coordination.settled


def test_a_team_that_splits_from_the_beginning_begins_by_agreeing(make_team):
    """For some seconds, whether it agrees or not."""
    team = make_team(coordination="split")
    assert team.coordination.begins(0.0)
    assert team.coordination.forming(0.0)
    assert not team.coordination.begins(TUNING.forming_time)
    team = make_team()
    team.look()
    assert not team.coordination.begins(team.now)


def test_a_large_team_agrees_on_nothing_and_uses_more_than_equal_parts(make_team):
    """Nobody has to tell of them. A message that is larger goes by turns, and alone in one."""
    team = make_team(names(TUNING.large_team), coordination="announce")
    team.look(waiting=99.0, using=0.6)
    assert team.coordination.team.splits
    assert team.coordination.part(team.now, 0) == pytest.approx(1.0 / (TUNING.large_team + 1))
    for _ in range(30):
        team.go_on()
        assert not team.look(waiting=99.0, using=0.1)
    assert team.coordination.part(team.now, 0) == pytest.approx(TUNING.overbooked / (TUNING.large_team + 1))
    assert team.coordination.announcement(team.now) is None
    assert team.coordination.settled
    limit = team.limits[0]
    equal = limit.limit / (TUNING.large_team + 1)
    assert team.coordination.turn(team.now, 0, limit, TUNING.turn_parts * equal) == NOT_NEEDED
    began = {team.coordination.turn(team.now + 0.02 * n, 0, limit, 4.0 * equal).began for n in range(1000)}
    assert math.inf in began
    assert 1 < len(began) < 6
    assert -math.inf not in began
    team.coordination.set_members(team.now, names(TUNING.large_team - 1))
    team.look(waiting=99.0)
    assert team.coordination.announcement(team.now) is not None
    assert team.coordination.turn(team.now, 0, limit, 4.0 * equal) == NOT_NOW, "turns are agreed on"


def test_where_a_large_team_splits_strictly_each_has_an_equal_part(make_team):
    """However little it uses of it."""
    team = make_team(names(TUNING.large_team), coordination="split")
    for _ in range(200):
        team.look(using=0.1)
    equal = (1.0 - team.view.settings.floor) / (TUNING.large_team + 1)
    assert team.coordination.part(team.now, 0) == pytest.approx(equal, rel=0.06)
    assert team.coordination.turn(team.now, 0, team.limits[0], team.limits[0].limit) == NOT_NOW
    assert team.coordination.announcement(team.now) is None


@pytest.mark.parametrize(
    ("sizes", "left"), [((1000, 1000), 0.0), ((400, 3600), TUNING.varied_margin)], ids=["alike", "varied"]
)
def test_where_all_large_samples_vary_in_size_a_margin_is_left(make_team, sizes, left):
    """Then what fits beside others is sent all the same; where messages are alike a margin could cost a whole one."""
    team = make_team()
    for robot in ("r1", "p1"):
        stream = team.view.streams.touch(0.0, robot, f"robot/{robot}/camera")
        for count in range(9, 29):
            stream.note_generated(count + 1, Generated(count - 28.5, sizes[count % 2], 1.0))
    team.now = 0.0
    team.look()
    assert team.coordination.team.rivals
    assert team.coordination.part(team.now, 0) == 1.0 - left


def test_who_is_alone_leaves_no_margin(make_team):
    """There is nobody whose news could be late."""
    team = make_team(send=1)
    stream = team.view.streams.touch(0.0, "r1", "robot/r1/camera")
    for count in range(9, 29):
        stream.note_generated(count + 1, Generated(count - 28.5, (400, 3600)[count % 2], 1.0))
    team.look()
    assert team.coordination.part(team.now, 0) == 1.0


def test_what_was_sent_before_the_team_split_keeps_no_slot(make_team):
    """It was not larger than it might be then, so it has one window: its slot is passed on in time."""
    team = make_team()
    team.look()
    assert not team.coordination.binds
    sent = team.now
    team.coordination.sent(sent, (0.4,))
    while not team.coordination.team.splits:
        team.look(waiting=TUNING.late_news * WINDOW)
    assert team.coordination.split_in_force.own_part.busy_until == sent


SECONDS = 8.0


def flown(workload, robots, contender, seed=0, later=0.0):
    """Let a team start all at once; return when it sent [s], and how much each of its windows held at most.

    Applications begin so much `later` [s], from which times count.
    """
    cell = Cell(workload, robots, 0.02, 0.01, seed, SECONDS - 5.0)
    how = how_of(cell, contender)
    mission = cell.mission(everybody=how.broadcasts)
    team = crew(mission, how, seed)
    team.run([replace(frame, t_gen=frame.t_gen + later) for frame in mission.frames], SECONDS + later)
    sent = sorted((air.t - later, air.size) for air in team.on_air if air.frame is not None)
    times, sizes = np.array([t for t, _ in sent]), np.array([size for _, size in sent])
    ends = np.searchsorted(times, times - mission.window, side="right")
    total = np.concatenate([[0], np.cumsum(sizes)])
    return times, (total[1:] - total[ends]) / mission.carried, team


@pytest.mark.full
@pytest.mark.parametrize(
    ("contender", "robots", "later"),
    [
        ("announce/unicast", 8, 0.0),
        pytest.param("announce/broadcast", 8, 0.0, marks=pytest.mark.full),
        pytest.param("announce/unicast", 10, 20.0, marks=pytest.mark.full),
        pytest.param("announce/unicast", 10, 0.0, marks=pytest.mark.full),
        pytest.param("announce/broadcast", 10, 0.0, marks=pytest.mark.full),
    ],
)
def test_a_team_of_equal_messages_sends_its_first_one_as_it_comes(contender, robots, later):
    """None fits an equal part, and to agree on others takes seconds; until then all plan for all, first in turns.

    Within the limit: that two send what only one of them may is seldom. Nor does it matter how long before its daemons
    were switched on.
    """
    over = 0
    for seed in range(8):
        times, held, _ = flown("uniform-mixed", robots, contender, seed, later)
        assert times[0] < 0.5 + TUNING.first_time
        assert sum(times < 2.5) >= 4
        assert sum(times < 7.5) >= 10
        assert held.max() <= 1.15
        over += held.max() > 1.0
    assert over <= 2


def test_who_asks_for_parts_by_configuration_uses_no_more_than_its_part(make_team):
    """However little of it it uses."""
    parts = []
    for using in (0.1, 1.0):
        team = make_team((), coordination="split")
        for _ in range(200):
            team.look(using=using)
        assert team.coordination.formation.established
        parts.append(team.coordination.part(team.now, 0))
    assert 0.0 < parts[0] == parts[1] < 1.0


@pytest.mark.full
def test_all_keep_to_their_parts_once_these_have_been_agreed_on_for_a_window():
    """Nobody has to announce what it sends any more."""
    _, _, team = flown("uniform-mixed", 8, "announce/unicast")
    for core in team.cores.values():
        assert core.parts.coordination.formation.established
        assert core.parts.coordination.binds


@pytest.mark.full
def test_who_asks_for_parts_by_configuration_never_plans_for_all():
    """The union holds at any latency and loss, so nobody sends what has no part yet."""
    times, _, _ = flown("uniform-mixed", 10, "split/unicast")
    assert times[0] > 1.0
