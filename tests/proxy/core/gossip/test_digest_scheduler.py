"""What a robot tells the others, and when."""

import math
from itertools import pairwise

import pytest

from proxy.core.coordination.tuning import TUNING as COORDINATION
from proxy.core.gossip.digest_scheduler import Retransmissions
from proxy.core.gossip.tuning import TUNING
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Drop, Forward, SendDigest, SendState
from proxy.core.model.limits import allowance_of
from proxy.core.model.settings import broadcast
from proxy.core.protocol.bid import Segment
from proxy.core.protocol.messages import Digest, State, StreamDigest, StreamState, tag
from proxy.core.protocol.split_report import SplitReport
from proxy.core.protocol.state_codec import pack_state
from proxy.core.samples.tuning import TUNING as SAMPLES
from proxy.core.view.tuning import TUNING as VIEW
from studies.simulation.conditions import WARM_UP, Conditions
from studies.simulation.flights import fly
from studies.simulation.missions import draw, scenario
from tests.proxy.core.talk import only

CAMERA = (StreamState(1, "robot/op/camera", "camera", 0.5),)


def sends(talk, now, **what):
    """Publish a sample that is sent, whatever it is worth."""
    sample, commands = talk.publish(now, **what)
    for decide in only(commands, Decide):
        commands = talk.answer(now, decide, send=True)
    assert Forward(sample) in commands


def digests(talk, since=0.0):
    return [sent.digest for sent in talk.all(SendDigest) if sent.digest.sent >= since]


@pytest.fixture
def talk(make_talk):
    """A robot whose camera another one wants, and knows; that has one, too."""
    talk = make_talk(allowance=0.05)
    talk.want(0.0)
    talk.tell(ev.StateHeard(0.0, State("op", "zz-op", "enforce", "", CAMERA, ("robot/*/camera",), number=1)))
    sends(talk, 0.1, size=100)
    talk.tell(ev.TimePassed(5.0))
    return talk


def test_states_follow_each_other_slowly(make_talk):
    """Whatever happens meanwhile is told by the next one."""
    talk = make_talk()
    talk.want(0.0)
    for step in range(50):
        talk.tell(ev.InterestChanged(1.0 + 0.01 * step, (f"k{step}",)))
    talk.tell(ev.TimePassed(60.0))
    states = talk.all(SendState)
    assert len(states) <= 3 + 0.5 / TUNING.states_apart
    assert states[-1].state.subscriptions == ("k49",)
    assert talk.core.gossip.states.state == states[-1].state


def test_what_applications_subscribe_to_is_told_ahead_of_the_allowance(make_talk):
    """Others plan for nothing that nobody is known to want. Where it changes all the time it waits as other news do."""
    talk = make_talk()
    talk.want(0.0)
    talk.tell(ev.TimePassed(60.0))
    before = len(talk.all(SendState))
    talk.tell(ev.InterestChanged(60.1, ("robot/*/camera",)))
    assert talk.all(SendState)[before:][-1].state.subscriptions == ("robot/*/camera",)
    for step in range(1, 100):
        talk.tell(ev.InterestChanged(60.1 + 0.3 * step, (f"robot/{step}/camera",)))
    states = talk.all(SendState)[before:]
    assert 1 < len(states) <= 2 + 2 * 29.7 / _state_takes(talk)


def _state_takes(talk):
    """For how long a state takes what may be spent on states [s]."""
    gossip = talk.core.gossip
    return gossip.budget.states.takes(len(pack_state(gossip.states.state)), gossip.account.copies)


def test_what_is_due_next_is_known(talk):
    """A state that may be news, at once or soon."""
    talk.tell(ev.TimePassed(10.0))
    assert talk.core.wake_at(10.0) > 10.0
    talk.core.gossip.states.review(10.0)
    assert talk.core.gossip.due_at(10.0) <= 10.0 + TUNING.states_apart


def test_what_was_sent_is_told_soon_even_if_no_spec_covers_it(talk):
    """If the allowance permits."""
    talk.tell(ev.SamplesPassed(5.1, "passed:no-spec", 1, 100))
    talk.tell(ev.TimePassed(8.0))
    assert digests(talk, 5.1)[-1].messages == 2


def test_what_takes_much_of_a_limit_is_announced_when_it_is_sent(talk):
    """Within a millisecond, while news of small samples wait."""
    sends(talk, 5.2, size=100)
    said = len(digests(talk, 5.2))
    for k in range(4):
        sends(talk, 5.3 + 0.3 * k, size=1500)
        talk.tell(ev.TimePassed(5.301 + 0.3 * k))
        told = [news.forwarded for digest in digests(talk, 5.3 + 0.3 * k) for news in digest.streams]
        assert told[-1] == 3 + k
    assert said <= 1
    assert any(digest.brief for digest in digests(talk, 5.2))


def test_an_announcement_goes_before_its_sample(talk):
    """On the air it would wait behind it, and others send meanwhile."""
    sample, commands = talk.publish(5.2, size=1500)
    for decide in only(commands, Decide):
        commands = talk.answer(5.203, decide, send=True)
    (told,) = only(commands, SendDigest)
    assert told.digest.brief
    assert commands.index(told) < commands.index(Forward(sample))


@pytest.mark.parametrize("echoed", [False, True])
def test_a_robot_that_nobody_echoed_yet_is_echoed_where_else_an_announcement_would_do(talk, echoed):
    """Until then it cannot know how long news take; what was sent is told with it, as soon."""
    sends(talk, 5.2, size=1000)
    talk.tell(ev.TimePassed(9.0))
    talk.tell(ev.DigestHeard(9.9, Digest("op", tag("zz-op"), 9.89), 1500))
    if echoed:
        talk.core.view.echoes.sent([tag("zz-op")])
    sends(talk, 10.0, size=1000)
    (told,) = digests(talk, 10.0)
    assert [news.forwarded for news in told.streams] == [3]
    assert (told.brief, [echo.peer for echo in told.echoes]) == ((True, []) if echoed else (False, [tag("zz-op")]))


def test_traffic_that_nobody_decides_on_is_not_announced(talk):
    """However large: others can learn nothing of it but how much it is, which the next digest tells."""
    for k in range(20):
        talk.tell(ev.SamplesPassed(5.2 + 0.01 * k, "passed:no-spec", 1, 50_000))
    assert len(digests(talk, 5.2)) <= 10
    assert not any(digest.brief for digest in digests(talk))


def test_announcements_name_streams_always(talk):
    """None is empty, whatever else goes on the air meanwhile."""
    for k in range(40):
        sends(talk, 5.2 + 0.6 * k, size=2000)
        talk.tell(ev.SamplesPassed(5.3 + 0.6 * k, "passed:no-spec", 1, 50))
    brief = [digest for digest in digests(talk) if digest.brief]
    assert brief
    assert all(digest.streams for digest in brief)


def test_no_two_digests_are_of_one_moment(make_talk):
    """Of two the second one would be taken for a repetition."""
    talk = make_talk(allowance=0.2)
    talk.want(0.0)
    for k in range(200):
        sends(talk, 0.1 + 0.3 * k, size=1500, red=0.1 * (k % 5))
        talk.tell(ev.TimePassed(0.1 + 0.3 * k))
    times = [digest.sent for digest in digests(talk)]
    assert len(times) > 100
    assert len(set(times)) == len(times)


def test_announcements_do_not_take_the_place_of_all_other_news(talk):
    """However much is sent, and whatever others tell: what only full digests tell goes out every few seconds."""
    for k in range(100):
        now = 5.2 + 0.2 * k
        for decide in only(talk.publish(now, size=1500)[1], Decide):
            talk.answer(now, decide, send=True)
        talk.tell(ev.DigestHeard(now + 0.05, Digest("op", "zz-op", now, brief=True, state=0), 100))
        talk.tell(ev.DigestHeard(now + 0.06, Digest("op", "zz-op", now + 0.01, brief=True, state=0), 100))
    full = [digest.sent for digest in digests(talk, 5.2) if not digest.brief]
    assert len(full) >= 4
    assert max(after - before for before, after in zip([5.2, *full], [*full, 25.2], strict=True)) <= 5.0


def test_urgent_news_that_the_allowance_has_no_room_for_hold_up_nothing(talk):
    """They go with the next digest that goes anyway."""
    talk.tell(ev.DigestHeard(5.1, Digest("op", "zz-op", 5.1, state=0), 50_000))
    talk.publish(5.2, red=0.9)
    assert talk.core.gossip.digests.urgent
    for k in range(20):
        talk.tell(ev.TimePassed(5.3 + 0.2 * k))
    assert digests(talk, 5.2)
    assert not talk.core.gossip.digests.urgent


def test_who_is_alone_tells_nothing(make_talk):
    """And everything to who comes."""
    talk = make_talk(allowance=0.05)
    talk.tell(ev.MatchingChanged(0.0, "robot/r1/camera", matching=True))
    for k in range(10):
        sends(talk, 1.0 + k, size=1500)
    assert digests(talk) == []
    talk.tell(ev.PeerAppeared(12.0, "op", "zz-op"))
    talk.tell(ev.StateHeard(12.0, State("op", "zz-op", "enforce", "")))
    talk.tell(ev.TimePassed(14.0))
    assert [news.forwarded for news in digests(talk)[0].streams] == [10]


@pytest.mark.full
@pytest.mark.parametrize(
    "how",
    [
        Conditions(robots=4, seconds=10.0, limit=5),
        Conditions(robots=4, seconds=10.0, limit=5, latency=0.2),
        pytest.param(Conditions(robots=6, seconds=10.0, limit=10, loss=0.1), marks=pytest.mark.full),
        Conditions(robots=4, seconds=10.0, transport="broadcast"),
    ],
    ids=["unicast", "late", "lossy", "broadcast"],
)
def test_all_digests_of_a_team_are_within_its_allowance_and_none_is_refused(how):
    """All copies of all robots' digests together, over a flight; some of it may be spent ahead."""
    mission = draw(scenario("mixed"), 0, how)
    team = fly(mission, how, 0)
    rate = allowance_of(mission.specs, how.allowance, how.members)
    assert 0 < team.digest_bytes <= rate * (WARM_UP + how.seconds + TUNING.announcement_debt)
    assert sum(core.news.refused.total() for core in team.cores.values()) == 0
    assert all(core.counts.conserved for core in team.cores.values())


def voting(now, **split):
    """A digest of the other robot, which finds that the team has to split."""
    return Digest("op", "zz-op", now, splits=True, split=SplitReport(1, (Segment(5_000, 120),), 1, 0, **split), state=1)


def test_news_of_parts_go_without_all_other_news(talk):
    """Where each robot has its part nobody plans with the others' streams: what is told of these has time."""
    talk.tell(ev.InterestChanged(5.0, ("robot/op/camera",)))
    news = StreamDigest(1, 9, 0, 5.0, 0.0, 100, 1.0)
    talk.tell(ev.DigestHeard(5.05, Digest("op", "zz-op", 5.05, streams=(news,), state=1), 60))
    talk.publish(5.1, size=100, red=0.5)
    talk.tell(ev.DigestHeard(5.2, voting(5.2), 60))
    for k in range(20):
        talk.publish(5.3 + 0.1 * k, size=100)
    told = [told.update for told in talk.all(SendState) if told.state.split is not None]
    assert all((each.streams, each.since) == ((), each.number) for each in told)
    versions = [each.split.version for each in told if each.split.bid is not None]
    assert versions[-1] > 0
    assert versions == sorted(set(versions))
    for k in range(100):
        talk.publish(7.4 + 0.2 * k, size=100)
    assert any(digest.streams for digest in digests(talk, 7.4))


def test_beside_parts_in_a_state_goes_a_first_digest():
    """As samples are taken for those of a robot only once it told something."""
    mission = draw(scenario("mixed"), 0, Conditions(robots=4, seconds=5.0, limit=5))
    team = fly(mission, Conditions(robots=4, seconds=5.0, limit=5), 0)
    assert all(core.coordination.split_in_force.agreement.formed for core in team.cores.values())
    heard = [peer.digest is not None for core in team.cores.values() for peer in core.view.peers.values()]
    assert heard == [True] * 20


def test_a_bid_does_not_wait_for_the_announcement_of_a_sample(make_talk):
    """All wait for what each asks for, and announcements may not go as far ahead of the allowance."""
    talk = make_talk(allowance=0.06)
    camera = StreamState(1, "robot/op/camera", "camera", 0.26, size=1600)
    talk.want(0.0)
    talk.tell(ev.StateHeard(0.0, State("op", "zz-op", "enforce", "", (camera,), ("robot/*/camera",), number=1)))
    talk.tell(ev.InterestChanged(0.0, ("robot/op/camera",)))
    talk.tell(ev.DigestHeard(0.05, Digest("op", "zz-op", 0.05, state=1), 80_000))
    for k in range(4):
        talk.publish(0.1 + 0.26 * k, size=1600)
    assert not any(digest.brief for digest in digests(talk, 0.1)), "nothing can be announced for some seconds"
    assert any(told.state.split is not None and told.state.split.bid for told in talk.all(SendState))


def test_where_digests_are_on_the_air_parts_are_told_in_them(make_talk):
    """There a copy of a state for each robot would take more. One of parts alone says so."""
    talk = make_talk(transport=broadcast("224.0.0.1:1"), digests_on_air=True, allowance=0.5)
    talk.want(0.0)
    talk.tell(ev.StateHeard(0.0, State("op", "zz-op", "enforce", "", CAMERA, ("robot/*/camera",), number=1)))
    sends(talk, 0.1, size=100)
    talk.tell(ev.TimePassed(5.0))
    talk.tell(ev.InterestChanged(5.0, ("robot/op/camera",)))
    news = StreamDigest(1, 9, 0, 5.0, 0.0, 100, 1.0)
    talk.tell(ev.DigestHeard(5.05, Digest("op", "zz-op", 5.05, streams=(news,), state=1), 60))
    talk.tell(ev.DigestHeard(5.2, voting(5.2), 60))
    for k in range(20):
        talk.publish(5.3 + 0.1 * k, size=100)
    told = digests(talk, 5.2)
    assert any(digest.split is not None and digest.split.bid for digest in told)
    assert any(digest.partial for digest in told)
    assert not any(digest.partial and digest.streams for digest in told)
    assert all(told.state.split is None for told in talk.all(SendState))


def test_who_changes_over_is_heard_though_announcements_are_ahead_of_the_allowance(talk):
    """Its vote is what ends them: in a team of ten it waited for twelve seconds."""
    talk.tell(ev.InterestChanged(5.0, ("robot/op/camera",)))
    news = StreamDigest(1, 9, 0, 5.0, 0.0, 100, 1.0)
    talk.tell(ev.DigestHeard(5.05, Digest("op", "zz-op", 5.05, streams=(news,), state=1), 60))
    ahead = round(TUNING.announcement_debt * talk.core.gossip.budget.rate)
    talk.tell(ev.DigestHeard(5.1, Digest("op", "zz-op", 5.1, brief=True, state=1), ahead))
    talk.publish(5.15, size=100)
    talk.tell(ev.DigestHeard(5.2, voting(5.2), 60))
    talk.tell(ev.TimePassed(5.3))
    assert any(told.update.splits is told.state.splits for told in talk.all(SendState) if told.state.split is not None)


def test_who_has_just_met_somebody_announces_what_it_sends(make_talk):
    """The other one may send before it can say so; who turns out to send nothing need not know at once."""
    talk = make_talk(allowance=0.05)
    talk.want(0.0)
    told = []
    for begin in (1.0, 1.5 + VIEW.newcomer_time):
        talk.tell(ev.TimePassed(begin - 0.1))
        for now in (begin, begin + 0.05, begin + 0.1, begin + 0.15):
            sends(talk, now, size=1500)
            talk.tell(ev.TimePassed(now + 0.001))
        told.append(len([d for d in digests(talk, begin) if d.sent < begin + 0.2 and d.brief]))
    assert told[0] >= 2
    assert told[1] == 0


def test_announcements_leave_out_what_is_small(talk):
    """What small streams send is booked by their rates."""
    sends(talk, 5.1, key="robot/x/camera", size=50)
    sends(talk, 5.2, size=1000)
    talk.tell(ev.TimePassed(9.0))
    talk.tell(ev.DigestHeard(9.9, Digest("op", tag("zz-op"), 9.89), 1500))
    talk.core.view.echoes.sent([tag("zz-op")])
    sends(talk, 10.0, key="robot/x/camera", size=50)
    sends(talk, 10.0, size=1000)
    talk.tell(ev.TimePassed(10.002))
    large = talk.core.view.streams.known("r1", "robot/r1/camera").id
    told = digests(talk, 10.0)
    assert told[-1].brief
    assert {stream.id for digest in told for stream in digest.streams} == {large}


def many(talk, now, count=COORDINATION.large_team):
    """So many robots appear, and each answers."""
    for number in range(count):
        talk.tell(ev.PeerAppeared(now, f"x{number}", f"{number:08x}"))
        state = State(f"x{number}", f"{number:08x}", "enforce", "", (), (), number=1)
        talk.tell(ev.StateHeard(now, state, len(pack_state(state))))


@pytest.mark.parametrize(("others", "allowance", "states"), [(2, 0.05, 2), (16, 0.001, 1)])
def test_where_a_state_takes_long_large_streams_that_begin_together_are_told_together(
    make_talk, others, allowance, states
):
    """Each to every other robot, and all of the team do that in the same moment."""
    talk = make_talk(allowance=allowance)
    talk.want(0.0)
    many(talk, 5.0, others)
    talk.tell(ev.TimePassed(60.0))
    talk.said.clear()
    for k in range(2):
        talk.publish(60.0 + 0.3 * k, key=f"robot/{k}/camera", size=1500)
        talk.tell(ev.TimePassed(60.25 + 0.3 * k))
    assert len(talk.all(SendState)) == states
    talk.tell(ev.TimePassed(60.3 + TUNING.longest_apart))
    assert len(talk.all(SendState)[-1].state.streams) == 2


def test_where_a_large_team_has_equal_parts_news_of_streams_wait_for_the_allowance(make_talk):
    """Nobody plans with them."""
    talk = make_talk(coordination="split")
    many(talk, 0.0)
    talk.want(0.0)
    talk.tell(ev.TimePassed(1.0))
    talk.said.clear()
    talk.publish(2.0, size=100)
    for step in range(20):
        talk.tell(ev.TimePassed(2.0 + 0.5 * step))
    assert talk.all(SendState) == []
    for step in range(200):
        talk.tell(ev.TimePassed(12.0 + step))
    (told,) = [each for each in talk.all(SendState) if each.update is not None]
    assert [stream.key for stream in told.update.streams] == ["robot/r1/camera"]


def test_a_large_stream_is_told_of_at_once_and_small_ones_together(make_talk):
    """The allowance has paid for neither; another sample of a small one changes nothing."""
    talk = make_talk(allowance=0.05)
    talk.want(0.0)
    talk.tell(ev.TimePassed(5.0))
    talk.core.gossip.budget.states.owe(2_000, 1)
    talk.said.clear()
    for now in (5.0, 5.05, 5.1):
        talk.publish(now, key="robot/x/camera", size=10)
    talk.tell(ev.TimePassed(5.0 + 2.0 * TUNING.gather))
    assert talk.all(SendState) == []
    sends(talk, 6.0, size=2_000)
    (told,) = talk.all(SendState)
    assert {stream.key for stream in told.state.streams} == {"robot/x/camera", "robot/r1/camera"}


@pytest.mark.parametrize("answered", [True, False])
def test_what_is_told_waits_for_the_answer_of_a_search(make_talk, answered):
    """One digest tells that a sample was generated and sent; where no answer comes it tells the former soon."""
    talk = make_talk(allowance=0.5)
    talk.want(0.0)
    for now in (6.0, 7.0):
        sends(talk, now)
    _, (*_, decide) = talk.publish(8.0)
    assert digests(talk, 8.0) == []
    if answered:
        talk.answer(8.001, decide, send=True)
    else:
        talk.tell(ev.TimePassed(8.0 + SAMPLES.answered_within))
    (digest,) = digests(talk, 8.0)
    ((generated, forwarded),) = [(stream.generated, stream.forwarded) for stream in digest.streams]
    assert generated - forwarded == (0 if answered else 1)


@pytest.mark.parametrize(("lost", "again"), [(0, 0), (10, 1), (30, 3)])
def test_what_is_announced_on_the_air_is_told_again_where_much_is_lost(make_talk, lost, again):
    """With the same numbers, as of another time."""
    talk = make_talk(transport=broadcast("224.0.0.1:1"), digests_on_air=True, allowance=0.5)
    talk.want(0.0)
    talk.tell(ev.StateHeard(0.0, State("op", "zz-op", "enforce", "", CAMERA, ("robot/*/camera",), number=1)))
    peer = talk.core.view.peers[tag("zz-op")]
    peer.outbound.losses.read(0, 0)
    peer.outbound.losses.read(100, 100 - lost)
    talk.tell(ev.TimePassed(5.0))
    sends(talk, 6.0, size=2_000)
    for step in range(1, 900):
        talk.tell(ev.TimePassed(6.0 + 0.001 * step))
    sent = [s for d in digests(talk, 6.0) for s in d.streams if s.t_forwarded == pytest.approx(6.0)]
    assert len(sent) == 1 + again
    assert len({s.forwarded for s in sent}) == 1


@pytest.fixture
def roomy(make_talk, make_specs):
    """A robot with a camera that uses a thousandth of the limit; another one wants it."""
    talk = make_talk(make_specs("100 Mbit/s"), allowance=0.02)
    talk.want(0.0)
    for step in range(40):
        publish_fitting(talk, 1.0 + 0.01 * step)
    return talk


def publish_fitting(talk, now, **what):
    """Publish a sample for which there is room; return whether it was sent as it came."""
    sample, commands = talk.publish(now, size=100, **what)
    for decide in only(commands, Decide):
        talk.answer(now, decide, send=True)
    return Forward(sample) in commands


def test_where_there_is_room_for_all_news_gather(roomy):
    """However often samples come, and however much of the allowance is left; in the end all of it was told."""
    assert all(publish_fitting(roomy, 2.0 + 0.005 * step) for step in range(200))
    told = digests(roomy, 2.0)
    assert len(told) == pytest.approx(1.0 / TUNING.relaxed, abs=2.0)
    due = told[-1].sent + TUNING.relaxed
    assert roomy.core.wake_at(2.995) <= due
    roomy.tell(ev.TimePassed(due))
    (last,) = digests(roomy, due)
    assert [(each.generated, each.forwarded) for each in last.streams] == [(240, 240)]


def test_where_nobody_else_sends_news_gather(make_talk):
    """However short room is, and however much of the allowance is left: who only listens plans with none of it."""
    talk = make_talk(allowance=0.5)
    talk.want(0.0)
    for step in range(int(100 * VIEW.newcomer_time)):
        now = 1.0 + 0.02 * step
        if step % 50 == 0:
            talk.tell(ev.DigestHeard(now, Digest("op", tag("zz-op"), now - 0.01), 100))
        for decide in only(talk.publish(now + 0.001, size=1000)[1], Decide):
            talk.answer(now + 0.005, decide, send=True)
    assert len(talk.all(Drop)) > 200
    known = 1.5 + VIEW.newcomer_time  # and what had waited until then is told
    assert len(digests(talk, known)) <= (now - known) / TUNING.relaxed + 2


def test_who_has_nothing_to_tell_is_heard_now_and_then(make_talk):
    """More seldom in unicast while nobody sends anything; on the air as often as ever."""
    for on_air, seconds in ((False, TUNING.nothing_sent), (True, TUNING.slowest_digest)):
        talk = make_talk(allowance=0.5, digests_on_air=on_air)
        talk.want(0.0)
        now = 2.0
        while (now := talk.core.wake_at(now)) < 20.0:
            talk.tell(ev.TimePassed(now))
            now += 1e-6
        told = [digest.sent for digest in digests(talk, 6.0)]
        assert min(later - sooner for sooner, later in pairwise(told)) >= seconds - 1e-6
        assert len(told) == pytest.approx(14.0 / seconds, abs=2.0)


def test_what_alters_the_plans_of_others_is_told_at_once_all_the_same(roomy):
    """That a sample is worth eleven times as much as the one before it."""
    assert publish_fitting(roomy, 2.0)
    told = digests(roomy)[-1].sent
    publish_fitting(roomy, told + 0.01, red=1.0)
    assert digests(roomy)[-1].sent == told + 0.01


AFTER = TUNING.retransmit_after
MOST = TUNING.retransmissions


def sent(again, until=10.0):
    """When it was sent again until then, and what."""
    found = []
    while again.due_at <= until:
        found.append((again.due_at, again.take(again.due_at)))
    return found


@pytest.mark.parametrize(("lost", "times"), [(0.0, 0), (0.01, 0), (0.05, 0), (0.1, 1), (0.3, 3), (0.9, MOST)])
def test_it_is_told_until_few_have_missed_it(lost, times):
    """The sample itself and the announcement are two of the times."""
    again = Retransmissions()
    again.announced(Digest("r1", "z", 1.0, state=7, brief=True), lost)
    found = sent(again)
    assert len(found) == times
    assert times == MOST or lost ** (2 + times) <= TUNING.missed
    assert all(digest == Digest("r1", "z", at, state=7, brief=True) for at, digest in found)
    assert again.due_at == math.inf


def test_each_time_comes_later_than_the_one_before():
    """What is lost in a row is lost together."""
    again = Retransmissions()
    again.announced(Digest("r1", "z", 1.0), 0.5)
    times = [at for at, _ in sent(again)]
    assert times == pytest.approx([1.0 + AFTER, 1.0 + 3 * AFTER, 1.0 + 7 * AFTER])


def test_nothing_is_told_before_it_is_due_and_the_newest_takes_the_place_of_the_last():
    """Both count from when they were announced."""
    again = Retransmissions()
    assert again.take(5.0) is None
    again.announced(Digest("r1", "z", 1.0, state=1), 0.3)
    assert again.take(1.0 + 0.5 * AFTER) is None
    again.announced(Digest("r1", "z", 2.0, state=2), 0.1)
    assert [digest.state for _, digest in sent(again)] == [2]


def test_that_a_large_stream_ceased_is_told_at_once(talk):
    """Others leave it room, for what they know of it is as old as its last sample; and that it began again."""
    for k in range(12):
        sends(talk, 5.2 + 0.5 * k, key="robot/x/camera", size=1500)
    camera = talk.core.view.streams.known("r1", "robot/x/camera")
    ends = camera.schedule.over_at
    talk.tell(ev.TimePassed(ends - 0.01))
    talk.tell(ev.TimePassed(ends + 2.0 * TUNING.surely_over))
    told = [news for digest in digests(talk, ends) for news in digest.streams if news.id == camera.id]
    assert [(news.generated, news.forwarded) for news in told] == [(12, 12)]
    talk.tell(ev.TimePassed(ends + 5.0))
    talk.publish(ends + 5.5, key="robot/x/camera", size=1500)
    assert [news.generated for digest in digests(talk, ends + 5.5) for news in digest.streams] == [13]
