"""Whether a team splits the limits: what each robot finds, and what all do."""

import pytest

from planner import Exponential, Linear, Step
from proxy.core.coordination.tuning import TUNING
from proxy.core.interface import events as ev
from proxy.core.model.settings import broadcast
from proxy.core.protocol.bid import Segment
from proxy.core.protocol.messages import Digest, State, StreamState
from proxy.core.protocol.split_report import SplitReport
from proxy.core.view.stream import Generated, Sent
from studies.simulation.traffic.flights import How, crew
from studies.simulation.traffic.kinds import Kind
from studies.simulation.traffic.missions import draw_from
from studies.simulation.traffic.scores import score
from studies.simulation.traffic.workloads import MBIT, Workload
from tests.proxy.core.coordination.conftest import WINDOW, Robot, names


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
    assert team.coordination.part(team.now, 0) < 1.0
    team.look(**less)
    assert team.coordination.team.votes_to_split
    team.look(**little)
    assert not team.coordination.team.votes_to_split
    assert team.coordination.part(team.now, 0) == 1.0


@pytest.mark.parametrize(
    ("size", "affordable"),
    [
        (1_000, TUNING.affordable),
        (2_000, 0.85),
        (6_000, TUNING.affordable_at_most),
        (7_000, TUNING.affordable_turns),
    ],
)
def test_announcements_may_cost_more_the_fewer_messages_an_equal_part_holds(make_team, size, affordable):
    """For few of them leave much of it; and larger ones would go by turns, which have to be told, too."""
    for announcing, splits in ((0.99, False), (1.01, True)):
        team = make_team(size=size)
        for _ in range(2 + round(TUNING.dear_time / TUNING.interval)):
            team.look(announcing=announcing * affordable)
        assert team.coordination.team.splits is splits
        assert team.coordination.team.tight is (announcing * affordable > TUNING.affordable)


def test_what_is_never_sent_makes_no_announcement_affordable(make_team):
    """Beside frames that are larger than any limit lets pass all else seemed to leave turns to tell of."""
    announcing = 1.01 * TUNING.affordable
    for sent in (False, True):
        team = make_team(size=1_000)
        frames = team.view.streams.touch(0.0, "p1", "robot/p1-back/camera")
        for count in range(9):
            frames.note_generated(count + 1, Generated(count - 8.5, 10**6, 1.0))
        for _ in range(2 + round(TUNING.dear_time / TUNING.interval)):
            if sent:
                team.view.traffic.note_sent(frames, frames.forwarded + 1, Sent(team.now, team.now, 10**6, 1.0))
            team.look(announcing=announcing)
        assert team.coordination.team.splits is not sent


def test_where_only_one_robot_has_something_to_send_no_announcement_is_missed(make_team):
    """It announces nothing, so the allowance is enough for what it tells."""
    team = make_team(send=1)
    team.look(announcing=2.0)
    assert not team.coordination.team.tight


def test_who_has_nothing_to_send_does_not_ask_for_a_split(make_team):
    """An operator hears digests behind the frames that it gets; that they are late harms nobody."""
    team = make_team(send=0)
    for robot in ("p1", "p2"):
        stream = team.view.streams.touch(0.0, robot, f"robot/{robot}/camera")
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
        team.go_on()
        team.look()
        assert team.coordination.team.votes_to_split is (sent == 6.0)


def test_where_only_one_robot_has_something_to_send_it_has_all(make_team):
    """However late news are: there is nobody to split with. Of a large team some always have."""
    team = make_team(send=1)
    assert not team.look(waiting=99.0)
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


def test_who_asks_for_a_part_is_a_rival_however_seldom_its_streams_are_told_of(make_team):
    """Else a team would change back and forth."""
    team = make_team(("p1",), send=1)
    team.look(waiting=99.0)
    assert not team.coordination.team.rivals
    stream = team.view.streams.touch(0.0, "p1", "robot/p1/camera")
    for count in range(9):
        stream.note_generated(count + 1, Generated(count - 8.5, 1000, 1.0))
    team.look(waiting=99.0)
    assert team.coordination.team.splits
    team.say("p1", splits=True, split=SplitReport(1, (Segment(5_000, 120),), 1, 0))
    team.now += 60.0
    for count in range(9, 80):
        own = team.view.streams.touch(0.0, "r1", "robot/r1/camera")
        own.note_generated(count + 1, Generated(count - 8.5, 1000, 1.0))
    team.look(waiting=99.0)
    assert team.coordination.team.rivals
    team.say("p1", splits=True, split=SplitReport(2, (), 1, 0))
    team.look(waiting=99.0)
    assert not team.coordination.team.rivals


def test_very_many_that_send_at_once_split_though_each_hears_all(make_team):
    """News come too late where fifty send; and before all are known to."""
    few = round(0.9 * TUNING.most * TUNING.large_team)
    team = make_team(names(TUNING.large_team), send=few)
    team.look()
    assert not team.coordination.team.splits
    team = make_team(names(TUNING.large_team - 1), send=TUNING.large_team)
    team.look()
    assert not team.coordination.team.splits, "these can agree on parts"
    team = make_team(names(TUNING.large_team), send=TUNING.large_team)
    team.look()
    assert team.coordination.team.splits
    assert team.coordination.team.large


def test_robots_of_which_samples_came_before_any_digest_are_among_the_many(make_team):
    """Of equal parts nobody says anything, so nothing else is known of them."""
    team = make_team(names(TUNING.large_team), transport=broadcast("224.0.0.226:7449"))
    rhythms(team)
    tell(team, team.view.peers, 0)
    team.now = TUNING.ways_time
    team.look()
    assert not team.coordination.team.votes_to_split
    for name in names(round(TUNING.most * (TUNING.large_team + 1))):
        team.view.overhearing.take(ev.SampleHeard(team.now, f"robot/{name}/camera", 300, name, None, None))
    team.look()
    assert team.coordination.team.votes_to_split


def rhythms(team, *, period=1.0, size=300, others=300, theirs=1.0):
    """Our camera, and what the others' states tell of theirs."""
    for count in range(9):
        stream = team.view.streams.touch(0.0, "r1", "robot/r1/camera")
        stream.matching = True
        stream.note_generated(count + 1, Generated((count - 9) * period, size, 1.0))
    for peer in team.view.peers.values():
        told = StreamState(1, f"robot/{peer.robot}/camera", "camera", theirs, size=others)
        peer.take_state(0.0, State(peer.robot, peer.zid, "enforce", "", streams=(told,), number=1))


@pytest.mark.parametrize(
    ("known", "splits"),
    [
        ({}, True),
        ({"theirs": 0.0}, True),
        ({"period": 0.1}, False),
        ({"theirs": 0.1}, False),
        ({"others": 90_000}, False),
        ({"period": 600.0, "theirs": 600.0}, False),
    ],
    ids=["seldom", "untold", "ours often", "theirs often", "theirs large", "room for all"],
)
def test_where_large_samples_come_seldom_a_team_splits(make_team, known, splits):
    """None takes more than a fifth of a limit, and there is no room for all; what is not told is taken for ours."""
    team = make_team(names(9), send=0)
    fifth = round(0.15 * team.limits[0].limit)
    rhythms(team, **({"size": fifth, "others": fifth} | known))
    team.look()
    assert team.coordination.team.seldom is splits
    assert not team.coordination.team.agrees, (
        "nobody overhears anything, and what they say would take much of the limit"
    )


def test_what_comes_seldom_and_goes_to_several_is_as_large_as_all_its_copies(make_team):
    """Of others as of ours."""
    for key in ("robot/r1/camera", "robot/p00/camera"):
        team = make_team(names(9), send=0)
        size = round(0.15 * team.limits[0].limit)
        rhythms(team, size=size, others=size)
        for receivers in (1, 2):
            team.view.subscribers.set(f"x{receivers}", (key,))
            team.look()
            assert team.coordination.team.seldom is (receivers < 2 and key.startswith("robot/r1"))


@pytest.mark.parametrize(
    ("robots", "waiting", "limit", "splits"),
    [
        (TUNING.announcing_robots, 0.99, "8 Mbit/s", False),
        (TUNING.announcing_robots, 1.01, "8 Mbit/s", True),
        (TUNING.announcing_robots + 1, 0.99, "8 Mbit/s", True),
        (TUNING.announcing_robots, 0.99, "160 kbit/s", True),
    ],
    ids=["soon", "late", "many robots", "news take much of the limit"],
)
def test_what_comes_seldom_is_announced_in_unicast_where_that_takes_little_and_news_soon_come(
    make_specs, robots, waiting, limit, splits
):
    """Each plans the same for all then, and parts of the limit do not stay unused until a sample comes."""
    team = Robot(make_specs(limit, window=WINDOW), names(robots - 1), send=0)
    size = round(0.15 * team.limits[0].limit)
    rhythms(team, size=size, others=size)
    for _ in range(9):
        team.look(waiting=waiting * TUNING.announced_news * WINDOW)
    assert team.coordination.team.seldom
    assert team.coordination.team.splits is splits
    assert team.coordination.team.agrees is (not splits)


@pytest.mark.parametrize(
    ("announcing", "limit", "gives_up"),
    [(1.1, "8 Mbit/s", True), (0.1, "8 Mbit/s", False), (0.1, "0.3 Mbit/s", True)],
    ids=["words cost too much", "announced", "words would take long"],
)
def test_who_can_neither_agree_nor_announce_keeps_to_an_equal_part(make_specs, announcing, limit, gives_up):
    """It waits for the others' bids for a while first; where announcements are affordable it plans for all then."""
    team = Robot(make_specs(limit, window=WINDOW), names(9), send=10)
    while team.now < 3.0 * TUNING.agreement_time:
        for stream in team.view.streams:
            stream.note_generated(stream.generated + 1, Generated(team.now, 1_000, 1.0))
        team.say("p01", split=SplitReport(1, (Segment(1000, 100, 4),), 7, 0, (), 0.0, 0), splits=True)
        team.look(announcing=announcing, using=1.0)
    assert team.coordination.team.gave_up is gives_up
    assert team.coordination.team.quiet is gives_up
    assert team.coordination.equal.by_clock is gives_up, "what is larger goes by turns"
    if gives_up:
        assert team.coordination.split_in_force is None, "nothing is agreed on any more"
        assert team.coordination.part(team.now, 0) == pytest.approx(0.1, rel=0.1)


@pytest.mark.parametrize(
    ("limit", "level", "gives_up"),
    [("0.3 Mbit/s", 100, True), ("8 Mbit/s", 100, False), ("0.3 Mbit/s", 160, False)],
    ids=["dear", "words are cheap", "one needs more"],
)
def test_slots_that_are_not_worth_the_words_to_pass_them_on_are_given_up_at_once(make_specs, limit, level, gives_up):
    """All have the same table, and find so in the moment in which they agree on it."""
    team = Robot(make_specs(limit, window=WINDOW), names(9), send=10)
    agree_on_slots(team, level, announcing=1.1)
    assert team.coordination.team.gave_up is gives_up


def test_who_gives_such_slots_up_has_an_equal_part_though_announcements_are_not_dear(make_specs):
    """And words take no two seconds, as windows are short: who planned for all instead would hear of them too late."""
    window = 0.2
    team = Robot(make_specs("1.5 Mbit/s", window=window), names(9), send=10)
    agree_on_slots(team, 100, waiting=1.05 * TUNING.late_news * window)
    assert team.view.words_take(10) <= TUNING.slow_words
    for _ in range(3):
        assert team.coordination.team.gave_up
        assert team.coordination.team.quiet
        team.look(waiting=1.05 * TUNING.late_news * window, using=1.0)


def agree_on_slots(team, level, **look):
    """Let ten robots agree on slots, of which one asks for its own at another `level`, and look again."""
    while team.coordination.split_in_force is None or team.coordination.split_in_force.agreement.pending:
        assert team.now < TUNING.agreement_time
        for stream in team.view.streams:
            stream.note_generated(stream.generated + 1, Generated(team.now, 1_000, 1.0))
        team.look(using=1.0, **look)
        split = team.coordination.split_in_force
        table = 0 if split is None else split.agreement.log.newest.name
        for other in names(9):
            most = level if other == "p00" else 100
            bid = tuple(Segment(1500, most - less, quarters) for less, quarters in ((0, 1), (4, 1), (8, 2)))
            team.say(other, split=SplitReport(1, bid, table, 0, (), 0.0, 0), splits=True)
    assert len(team.coordination.split_in_force.agreement.turns) >= 4
    team.look(using=1.0, **look)


def test_a_team_begins_by_a_split_until_a_robot_knows_how_often_its_samples_come(make_team):
    """For a second or two at most; meanwhile it asks for nothing, and tells nothing of parts."""
    team = make_team(send=0)
    team.look()
    assert team.coordination.team.splits
    assert team.coordination.announcement(team.now) is None
    while team.now < TUNING.rhythm_time:
        team.look()
    assert not team.coordination.team.splits
    known = make_team()
    known.look()
    assert known.coordination.team.rhythms_known


def test_who_broadcasts_begins_by_a_split_until_it_knows_how_long_news_take(make_team):
    """But for so long only, and not beside others that plan for all."""
    teams = {known: make_team(names(9), send=0, transport=broadcast("224.0.0.226:7449")) for known in (True, False)}
    for known, team in teams.items():
        fifth = round(0.15 * team.limits[0].limit)
        rhythms(team, period=0.1, size=fifth, others=fifth, theirs=0.0)
        team.look()
        assert team.coordination.team.splits
        if known:
            offset = team.view.peers["p03"].offset
            offset.heard(0.1, 0.2)
            offset.echoed(0.1, 0.2)
    while teams[False].now < TUNING.ways_time - 2.0:
        for known, team in teams.items():
            team.look()
            assert team.coordination.team.splits is (not known)
    for _ in range(9):
        teams[False].look()
    assert not teams[False].coordination.team.splits
    beside = make_team(names(9), send=0, transport=broadcast("224.0.0.226:7449"))
    rhythms(beside, size=fifth, others=fifth)
    beside.look()
    assert not beside.coordination.team.splits


@pytest.mark.parametrize(("waiting", "splits"), [(1.01, True), (0.99, False)])
def test_what_comes_seldom_and_is_overheard_is_split_where_news_take_part_of_the_window(make_team, waiting, splits):
    """It is less than what takes other teams to a split; before that each plans the same for all."""
    team = make_team(names(9), send=0, transport=broadcast("224.0.0.226:7449"))
    fifth = round(0.15 * team.limits[0].limit)
    rhythms(team, size=fifth, others=fifth)
    team.look(waiting=waiting * TUNING.overheard_news * WINDOW)
    assert team.coordination.team.seldom
    assert team.coordination.team.splits is splits
    assert team.coordination.team.agrees is (not splits)


def test_robots_whose_samples_are_small_have_equal_parts_at_once_where_news_cost_too_much(make_team):
    """They need not agree on any, which would take news; how much each uses beyond its part is its own business."""
    team = make_team(names(TUNING.even_robots), send=TUNING.even_robots + 1)
    team.look(announcing=99.0)
    assert not team.coordination.team.quiet
    tell(team, names(TUNING.even_robots), 6)
    team.look(announcing=99.0)
    assert team.coordination.team.quiet
    assert team.coordination.part(team.now, 0) == pytest.approx(1.0 / (TUNING.even_robots + 1))
    for _ in range(60):
        team.look(announcing=99.0, using=0.5)
    assert team.coordination.part(team.now, 0) > 1.5 / (TUNING.even_robots + 1)
    for _ in range(9):
        team.look()
    assert team.coordination.part(team.now, 0) == 1.0


def test_who_hears_that_announcements_cost_another_one_too_much_keeps_to_an_equal_part_where_they_nearly_do(make_team):
    """A team at that point changes over together: who goes on to announce hears nothing of those that do not."""
    for heard, little, quiet in ((True, 1.0, True), (False, 1.0, False), (True, 0.9 * TUNING.hysteresis, False)):
        team = make_team(names(TUNING.even_robots), send=TUNING.even_robots + 1, size=1)
        tell(team, names(TUNING.even_robots), 6)
        team.say("p00", splits=heard)
        team.look(announcing=0.99 * little * TUNING.affordable)
        assert team.coordination.team.quiet is quiet


@pytest.mark.full
def test_a_team_for_which_announcing_comes_to_cost_too_much_changes_over_together():
    """One that announced no more seemed silent to the others for up to 9 s: 13 % of the windows were over the limit."""
    kinds = (
        Kind("camera", Exponential(1.0, 2.0), (7.0, 10.0), (7_000, 19_000), anew=True, at_random=True),
        Kind("status", Step(1.0, 10.0), (0.8, 1.1), (2_500, 6_900), anew=True),
        Kind("map", Linear(1.0, 0.7), (0.35, 0.5), (24_000, 29_000)),
    )
    how = How(latency=0.02, loss=0.0, before=30.0)
    mission = draw_from(Workload("margin", (kinds,) * 6, MBIT, 1.0), 1, 20.0, latency=how.latency)
    team = crew(mission, how, 1)
    team.run(mission.frames, mission.problem.t_end)
    assert all(core.budget.coordination.team.quiet for robot, core in team.cores.items() if robot != "op")
    assert score(mission, team, how.loss).over <= 0.03


def test_small_streams_beside_a_large_one_are_no_reason_for_equal_parts(make_team):
    """Whose camera sees more needs more."""
    team = make_team(names(TUNING.even_robots), send=TUNING.even_robots + 1)
    tell(team, names(TUNING.even_robots), 6, size=100, first=10_000)
    team.look(announcing=99.0)
    assert not team.coordination.team.quiet
    tell(team, names(TUNING.even_robots), 6, size=1_000, first=10_000)
    team.look(announcing=99.0)
    assert team.coordination.team.quiet


class Size(int):
    """A size that counts how often such are compared."""

    compared = 0

    def __gt__(self, other):
        Size.compared += 1
        return int(self) > other

    __ge__ = __gt__


def test_who_has_thousands_of_streams_stops_nobody(make_team):
    """Each size is looked at a few times: with 4,096 streams of a stranger each look took a second."""
    robots, streams = names(TUNING.even_robots), 1000
    team = make_team(robots, send=TUNING.even_robots + 1)
    tell(team, robots, streams, size=Size(9))
    team.look(announcing=99.0)
    assert team.coordination.team.quiet
    assert Size.compared < 10 * len(robots) * streams


def tell(team, robots, streams, size=0, first=0):
    """The states of these robots have come, who have so many streams each, of such sizes."""
    for name in robots:
        keys = [f"robot/{name}/camera{number}" for number in range(streams)]
        sizes = [first, *[size] * (streams - 1)][:streams]
        told = zip(keys, sizes, strict=True)
        team.view.peers[name].told = {key: StreamState(1, key, "camera", 1.0, size=each) for key, each in told}


def test_who_hears_nothing_of_the_others_keeps_to_its_part(make_team):
    """Of equal parts nobody says anything: that is no reason to take all. Who is known to send nothing has none."""
    robots = names(TUNING.even_robots + 1)
    team = make_team(robots, send=1)
    tell(team, robots, 6)
    team.view.heard_digest(59.0, Digest(robots[-1], robots[-1], 59.0))
    team.now = 60.0
    team.look(announcing=99.0)
    assert team.coordination.team.rivals
    assert team.coordination.part(team.now, 0) == pytest.approx(1.0 / (TUNING.even_robots + 1))


@pytest.mark.parametrize("senders", [1, 2])
def test_who_sends_alone_keeps_no_parts_for_those_who_listen(make_team, senders):
    """However dear announcing is: in a team of equal parts they said for ten seconds not that they only listen."""
    team = make_team(names(TUNING.even_robots + 2), send=senders)
    for number in range(6):
        stream = team.view.streams.touch(0.0, "r1", f"robot/r1-{number}/camera")
        for count in range(9):
            stream.note_generated(count + 1, Generated(count - 8.5, 100, 1.0))
    for _ in range(1 + round(TUNING.dear_time / TUNING.interval)):
        team.look(announcing=99.0)
    assert team.coordination.team.even is team.coordination.team.splits is (senders > 1)


@pytest.mark.parametrize(("receivers", "quiet"), [(1, True), (2, False)])
def test_equal_parts_do_where_they_hold_all_copies_of_a_sample(make_team, receivers, quiet):
    """Else they are agreed on."""
    team = make_team(names(TUNING.even_robots), send=TUNING.even_robots + 1)
    tell(team, names(TUNING.even_robots), 6)
    stream = team.view.streams.touch(0.0, "r1", "robot/r1/camera")
    size = round(0.6 * TUNING.even_parts * team.limits[0].limit / (TUNING.even_robots + 1))
    for count in range(9, 60):
        stream.note_generated(count + 1, Generated(count - 8.5, size, 1.0))
    for number in range(receivers):
        team.view.subscribers.set(f"x{number}", ("robot/r1/camera",))
    for _ in range(1 + round(TUNING.dear_time / TUNING.interval)):
        team.look(announcing=99.0)
    assert team.coordination.team.splits
    assert team.coordination.team.quiet is quiet


@pytest.mark.parametrize("coordination", ["announce", "split"])
def test_others_agree_on_parts(make_team, coordination):
    """Few robots, those of one stream each, where a sample is larger than some equal parts or an operator wants it."""
    few = make_team(names(TUNING.even_robots - 2), send=TUNING.even_robots - 1, coordination=coordination)
    large = make_team(names(TUNING.even_robots), send=TUNING.even_robots + 1, coordination=coordination)
    size = round(1.1 * TUNING.even_parts * large.limits[0].limit / (TUNING.even_robots + 1))
    single = make_team(names(TUNING.even_robots), send=TUNING.even_robots + 1, coordination=coordination)
    for team, streams in ((few, 6), (large, 6), (single, 1)):
        tell(team, team.coordination.team.members, streams)
    stream = large.view.streams.touch(0.0, "r1", "robot/r1/camera")
    for count in range(9, 60):
        stream.note_generated(count + 1, Generated(count - 8.5, size, 1.0))
    for team in (few, large, single):
        for _ in range(1 + round(TUNING.dear_time / TUNING.interval)):
            team.look(announcing=99.0)
        assert team.coordination.team.splits
        assert not team.coordination.team.quiet
