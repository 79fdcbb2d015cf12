"""Who plans for whom: every robot for all, or each for itself with its part of every limit."""

import pytest

from proxy.core.coordination.coordination import Coordination
from proxy.core.coordination.tuning import TUNING
from proxy.core.interface import events as ev
from proxy.core.model.limits import limits_of
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.bid import Segment
from proxy.core.protocol.messages import Digest, State, StreamDigest, StreamState
from proxy.core.protocol.split_report import SplitReport
from proxy.core.view.stream import Generated
from proxy.core.view.view import SharedView

WINDOW = 2.0
CAMERA = (StreamState(1, "robot/op/camera", "camera", 0.5),)


class Team:
    """A robot and others, whose news take as long as it is told; the first so many of all have something to `send`."""

    def __init__(self, specs, peers=("p1", "p2"), *, send=2, **settings):
        self.view = SharedView(CoreSettings("r1", "z1", **settings), specs)
        self.coordination = Coordination(0.0, self.view.settings, self.view)
        self.limits = limits_of(specs, 0.02, len(peers) + 1)
        self.now = 0.0
        for peer in peers:
            self.view.add_peer(0.0, peer, peer)
        self.coordination.set_limits(0.0, self.limits)
        self.coordination.set_members(0.0, peers)
        self.view.set_interest(("robot/**",))
        for robot in ("r1", *peers)[:send]:
            stream = self.view.stream(0.0, robot, f"robot/{robot}/camera")
            stream.matching = True
            for count in range(9):
                stream.note_generated(count + 1, Generated(count - 8.5, 1000, 1.0))

    def look(self, *, waiting=0.0, announcing=0.0, using=0.0):
        self.now += TUNING.interval
        return self.coordination.advance(self.now, self.limits, waiting, lambda _: announcing, lambda _: using)

    def say(self, peer, **digest):
        self.now += 0.01
        self.coordination.heard(self.now, Digest(peer, peer, self.now, **digest))


@pytest.fixture
def make_team(make_specs):
    return lambda *args, **rest: Team(make_specs(window=WINDOW), *args, **rest)


def test_each_plans_for_all_while_news_are_early_and_announcements_affordable(make_team):
    """All of every limit is what all have together."""
    team = make_team()
    assert not team.look(waiting=0.9 * TUNING.late_news * WINDOW, announcing=TUNING.affordable)
    assert not team.coordination.team.splits
    assert team.coordination.part(team.now, 0) == 1.0
    assert team.coordination.whole_turn(team.now, 0)


@pytest.mark.parametrize(
    ("enough", "less", "little"),
    [
        (
            {"waiting": 1.01 * TUNING.late_news * WINDOW},
            {"waiting": 0.9 * TUNING.late_news * WINDOW},
            {"waiting": 0.9 * TUNING.hysteresis * TUNING.late_news * WINDOW},
        ),
        (
            {"announcing": 1.01 * TUNING.affordable},
            {"announcing": 0.9 * TUNING.affordable},
            {"announcing": 0.9 * TUNING.hysteresis * TUNING.affordable},
        ),
    ],
    ids=["late", "dear"],
)
def test_where_news_are_late_or_cost_too_much_a_robot_finds_that_the_team_has_to_split(make_team, enough, less, little):
    """And still when it is a little less, so that it does not change its mind all the time."""
    team = make_team()
    for _ in range(1 + round(TUNING.dear_time / TUNING.interval)):
        team.look(**enough)
    assert team.coordination.team.votes_to_split
    assert team.coordination.team.splits
    assert team.coordination.part(team.now, 0) < 1.0 / 3.0
    team.look(**less)
    assert team.coordination.team.votes_to_split
    team.look(**little)
    assert not team.coordination.team.votes_to_split
    assert team.coordination.part(team.now, 0) == 1.0


def test_who_has_nothing_to_send_does_not_ask_for_a_split(make_team):
    """An operator hears digests behind the frames that it gets; that they are late harms nobody."""
    team = make_team(send=0)
    for robot in ("p1", "p2"):
        stream = team.view.stream(0.0, robot, f"robot/{robot}/camera")
        for count in range(9):
            stream.note_generated(count + 1, Generated(count - 8.5, 1000, 1.0))
    team.look(waiting=2.0 * TUNING.late_news * WINDOW)
    assert team.coordination.team.rivals
    assert not team.coordination.team.votes_to_split


def test_news_that_wait_on_their_way_are_late(make_team):
    """Whatever the way takes at best; one that was held up alone is no reason."""
    team = make_team()
    for sent, took in ((1.0, 0.01), (2.0, 0.9), (3.0, 0.01), (4.0, 0.9), (5.0, 0.9), (6.0, 0.9)):
        digest = Digest("p1", "p1", sent, brief=sent == 5.0)
        team.view.heard_digest(sent + took, digest)
        team.coordination.heard(sent + took, digest)
        team.now = max(team.now + TUNING.interval, sent + took)
        team.look()
        assert team.coordination.team.votes_to_split is (sent == 6.0)


def test_it_is_looked_at_now_and_then(make_team):
    """And only while there is somebody."""
    team = make_team()
    team.look()
    assert team.coordination.due_at(team.now) == team.now + TUNING.interval
    team.coordination.advance(team.now + 0.5 * TUNING.interval, team.limits, 99.0, lambda _: 99.0, lambda _: 0.0)
    assert not team.coordination.team.votes_to_split
    alone = make_team(())
    assert not alone.look(waiting=99.0, announcing=99.0)
    assert alone.coordination.due_at(alone.now) > 1e9


def test_where_only_one_robot_has_something_to_send_it_has_all(make_team):
    """However late news are: there is nobody to split with. Of a large team some always have."""
    team = make_team(send=1)
    assert not team.look(waiting=99.0, announcing=99.0)
    assert not team.coordination.team.splits
    crowd = make_team(tuple(f"p{number}" for number in range(TUNING.few_robots + 1)), send=1)
    crowd.look(waiting=99.0)
    assert crowd.coordination.team.splits


def test_what_an_operator_configured_stays(make_team):
    """Whatever news take, and whatever the others say."""
    team = make_team(coordination="split")
    team.look()
    assert team.coordination.team.splits
    team.say("p1", splits=False)
    assert team.coordination.team.splits


def test_a_team_splits_while_any_of_it_says_so(make_team):
    """Announcements do not say; who leaves says nothing any more."""
    team = make_team()
    team.look()
    team.say("p1", splits=True)
    assert team.coordination.team.splits
    team.say("p1", brief=True)
    assert team.coordination.team.splits
    team.say("p1")
    assert not team.coordination.team.splits
    team.say("p1", splits=True)
    team.coordination.set_members(team.now, ["p2"])
    assert not team.coordination.team.splits


def test_who_takes_no_part_has_no_say(make_team):
    """It has other limits, or is a stranger."""
    team = make_team()
    team.look()
    team.coordination.set_members(0.0, ["p2"])
    team.say("p1", splits=True, split=SplitReport(1, (), 1, 1))
    team.say("p9", splits=True, split=SplitReport(1, (), 1, 1))
    assert not team.coordination.team.splits


def test_a_robot_without_shared_limits_never_splits(make_specs):
    """There is nothing to have a part of."""
    text = '[[information_type]]\nname = "camera"\nkeys = ["robot/*/camera"]\nutility = { kind = "video" }\n'
    team = Team(make_specs(text=text))
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
    team.coordination.announced(Digest("us", "zz-us", team.now, splits=True, split=ours))
    assert team.coordination.part(team.now, 0) < 0.5 * equal
    team.say("p1", splits=True, split=SplitReport(1, None, ours.table, 0))
    team.look(waiting=99.0)
    assert team.coordination.formed
    assert not team.coordination.forming(team.now)
    assert 0.0 < team.coordination.part(team.now, 0) < 0.5 * equal


def test_who_asks_for_a_part_is_a_rival_however_seldom_its_streams_are_told_of(make_team):
    """Else a team would change back and forth."""
    team = make_team(("p1",), send=1)
    team.look(waiting=99.0)
    assert not team.coordination.team.rivals
    stream = team.view.stream(0.0, "p1", "robot/p1/camera")
    for count in range(9):
        stream.note_generated(count + 1, Generated(count - 8.5, 1000, 1.0))
    team.look(waiting=99.0)
    assert team.coordination.team.splits
    team.say("p1", splits=True, split=SplitReport(1, (Segment(5_000, 120),), 1, 0))
    team.now += 60.0
    for count in range(9, 80):
        team.view.stream(0.0, "r1", "robot/r1/camera").note_generated(count + 1, Generated(count - 8.5, 1000, 1.0))
    team.look(waiting=99.0)
    assert team.coordination.team.rivals
    team.say("p1", splits=True, split=SplitReport(2, (), 1, 0))
    team.look(waiting=99.0)
    assert not team.coordination.team.rivals


def test_a_team_that_splits_from_the_beginning_begins_by_agreeing(make_team):
    """For some seconds, whether it agrees or not."""
    team = make_team(coordination="split")
    assert team.coordination.begins(0.0)
    assert team.coordination.forming(0.0)
    assert not team.coordination.begins(TUNING.forming_time)
    assert not make_team().coordination.begins(0.0)


def names(count):
    return tuple(f"p{number:02d}" for number in range(count))


def test_a_large_team_agrees_on_nothing_and_uses_more_than_equal_parts(make_team):
    """Nobody has to tell of them. A message that is larger goes where nothing went for as many windows."""
    team = make_team(names(TUNING.large_team), coordination="announce")
    team.look(waiting=99.0, using=0.6)
    assert team.coordination.team.splits
    assert team.coordination.part(team.now, 0) == pytest.approx(1.0 / (TUNING.large_team + 1))
    for _ in range(30):
        assert not team.look(waiting=99.0, using=0.1)
    assert team.coordination.part(team.now, 0) == pytest.approx(TUNING.overbooked / (TUNING.large_team + 1))
    assert team.coordination.announcement(team.now) is None
    assert team.coordination.settled
    assert team.coordination.whole_turn(team.now, 0)
    team.coordination.set_members(team.now, names(TUNING.large_team - 1))
    team.look(waiting=99.0)
    assert team.coordination.announcement(team.now) is not None


def test_where_a_large_team_splits_strictly_each_has_an_equal_part(make_team):
    """However little it uses of it."""
    team = make_team(names(TUNING.large_team), coordination="split")
    for _ in range(200):
        team.look(using=0.1)
    equal = (1.0 - team.view.settings.floor) / (TUNING.large_team + 1)
    assert team.coordination.part(team.now, 0) == pytest.approx(equal, rel=0.06)
    assert not team.coordination.whole_turn(team.now, 0)
    assert team.coordination.announcement(team.now) is None


def test_very_many_that_send_at_once_split_though_each_hears_all(make_team):
    """News come too late where fifty send; until far fewer do."""
    team = make_team(names(TUNING.large_team), send=TUNING.large_team - 1)
    team.look()
    assert not team.coordination.team.splits
    team = make_team(names(TUNING.large_team), send=TUNING.large_team)
    team.look()
    assert team.coordination.team.splits
    assert team.coordination.team.large
