"""Two robots that would send in the same moment: the one with the better claim does."""

import math

import pytest

from proxy.core.coordination.claims import CLAIMING, Claims, both, claim, news_take
from proxy.core.coordination.tuning import TUNING
from proxy.core.forecast.rhythm import Rhythm
from proxy.core.market.disputes import Disputes
from proxy.core.market.standing import Standing
from proxy.core.model.lifetimes import worthless_from
from proxy.core.model.limits import limits_of
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import Digest, State, StreamDigest, StreamState, tag
from proxy.core.view.stream import Generated, Sent
from proxy.core.view.tuning import TUNING as VIEW
from proxy.core.view.view import SharedView

PERIOD, SIZE = 0.1, 1_000
CHEAP = 0.005
"""So little is a sample worth beside others that its room costs twice as much."""


@pytest.fixture
def view(make_specs):
    """Two robots with frames of 10 Hz and more to say than the limit carries; the other one is due at 10 s."""
    view = SharedView(CoreSettings("r1", "z1"), make_specs(window=0.25))
    view.add_peer(0.0, "r2", "z2")
    view.subscribers.set_own(("robot/**",))
    for robot in ("r1", "r2"):
        stream = view.streams.touch(0.0, robot, f"robot/{robot}/camera")
        stream.matching = True
        for count in range(100):
            stream.note_generated(count + 1, Generated(count * PERIOD, SIZE, 1.0))
    return view


def taken(view, now, *, grew=-math.inf):
    return judged(view, now, grew=grew)[0]


def judged(view, now, *, grew=-math.inf, agreed=False, free=math.inf):
    limits, disputes = limits_of(view.specs, 0.02, 2), Disputes(view)
    disputes.advance(now, limits, alone=False)
    stream = view.streams.known("r1", "robot/r1/camera")
    grows = grew if callable(grew) else lambda *_: grew
    return Claims(view, disputes).rivals(now, stream, limits, grows, lambda _: (free,), agreed=agreed)


def generated(view, t):
    """Our newest sample is of that time."""
    view.streams.known("r1", "robot/r1/camera").note_generated(101, Generated(t, SIZE, 1.0))


def sent(view, robot, t):
    view.traffic.note_sent(view.streams.known(robot, f"robot/{robot}/camera"), 1, Sent(t, t, SIZE, 1.0))


def test_a_better_claim_that_was_due_just_now_counts_as_taken(view):
    """The other one sent longer ago. Where all plans say the same nobody gives way: the plan says what it does."""
    sent(view, "r1", 9.9)
    sent(view, "r2", 9.0)
    assert taken(view, 10.0 + 0.5 * TUNING.deciding) == (SIZE,)
    assert judged(view, 10.0 + 0.5 * TUNING.deciding, agreed=True) == ((0.0,), math.inf)


@pytest.mark.parametrize("pause", [0.0, 5.0])
def test_who_begins_again_gives_way_until_others_can_know_of_it(view, pause):
    """They take its stream to have ceased, so they leave it nothing, however good its claim is."""
    news, now = news_take(view), 9.9 + pause
    other = view.streams.known("r2", "robot/r2/camera")
    for count in range(101, 101 + round(pause / PERIOD)):
        other.note_generated(count, Generated((count - 1) * PERIOD, SIZE, 1.0))
    sent(view, "r1", 1.0)
    sent(view, "r2", now - 0.2)
    generated(view, now + 0.1)
    gives_way = pause > 0.0
    assert (taken(view, now + 0.1) == (SIZE,)) is gives_way
    assert view.streams.known("r1", "robot/r1/camera").schedule.resumed == (now + 0.1 if gives_way else -math.inf)
    generated_later = view.streams.known("r1", "robot/r1/camera")
    generated_later.note_generated(102, Generated(now + 0.2, SIZE, 1.0))
    assert taken(view, now + 0.2 + news) == (0.0,)


@pytest.mark.parametrize("cheap", ["r1", "r2"])
def test_who_does_not_pay_for_its_room_has_no_claim(view, cheap):
    """It gives way to who does, however long it sent nothing, and nobody gives way to it."""
    stream = view.streams.known(cheap, f"robot/{cheap}/camera")
    for count in range(101, 301):
        stream.note_generated(count, Generated(count * PERIOD - 20.1, SIZE, CHEAP))
    sent(view, "r1", 9.9 if cheap == "r2" else 1.0)
    sent(view, "r2", 9.9 if cheap == "r1" else 1.0)
    limits, disputes = limits_of(view.specs, 0.02, 2), Disputes(view)
    disputes.advance(10.0, limits, alone=False)
    assert disputes.weighed(stream).standing in CLAIMING
    assert taken(view, 10.0 + 0.5 * TUNING.deciding) == ((0.0,) if cheap == "r2" else (SIZE,))


def test_a_worse_claim_waits_for_us(view):
    """So never do both wait, nor both send."""
    sent(view, "r1", 9.0)
    sent(view, "r2", 9.5)
    generated(view, 10.0)
    assert taken(view, 10.0 + 0.5 * TUNING.deciding) == (0.0,)


def test_a_sample_that_others_do_not_count_any_more_gives_way_to_worse_claims(view):
    """Who gave way for long, to one of whom it lacked the news, does not send beside those that know better."""
    sent(view, "r1", 9.0)
    sent(view, "r2", 9.5)
    generated(view, 10.0 - 2.0 * news_take(view))
    assert taken(view, 10.0 + 0.5 * TUNING.deciding) == (SIZE,)
    assert judged(view, 10.0 + 0.5 * TUNING.deciding)[1] == pytest.approx(10.0 + news_take(view))


def test_who_waited_with_the_best_claim_for_room_that_opened_just_now_gives_way_to_nobody(view):
    """The others leave it that room."""
    sent(view, "r1", 9.0)
    sent(view, "r2", 9.5)
    now = 10.0 + 0.5 * TUNING.deciding
    generated(view, 10.0 - 2.0 * news_take(view))
    assert taken(view, now, grew=now) == (0.0,)


def test_of_equal_claims_one_is_better(view):
    """Names tell which, alike everywhere."""
    sent(view, "r1", 9.5)
    sent(view, "r2", 9.5)
    assert taken(view, 10.0 + 0.5 * TUNING.deciding) == (SIZE,)


def test_a_better_claim_that_comes_before_it_can_have_heard_of_us_counts_as_taken(view):
    """It would not wait for us; what comes later knows what we sent."""
    sent(view, "r1", 9.85)
    sent(view, "r2", 9.0)
    assert taken(view, 10.0 - 0.9 * news_take(view)) == (SIZE,)
    assert taken(view, 10.0 - 2.0 * news_take(view)) == (0.0,)


def test_what_we_would_have_heard_of_by_now_was_not_sent(view):
    """News take as long as the way, and deciding."""
    sent(view, "r1", 9.9)
    sent(view, "r2", 9.0)
    assert taken(view, 10.0 + 2.0 * news_take(view)) == (0.0,)


def test_what_we_know_to_be_sent_is_counted_elsewhere(view):
    """It is no guess any more."""
    sent(view, "r1", 9.0)
    sent(view, "r2", 10.0)
    view.streams.known("r2", "robot/r2/camera").renew(Generated(9.9, SIZE, 100.0))
    assert taken(view, 10.0 + 0.5 * TUNING.deciding) == (0.0,)


def test_what_comes_at_random_counts_by_how_likely_it_was_sent(view):
    """Nobody knows when it is due: no more of it than would be taken of what was."""
    sent(view, "r1", 9.9)
    sent(view, "r2", 9.0)
    view.streams.known("r2", "robot/r2/camera").schedule.assume(PERIOD, "poisson")
    likely = 1.0 - math.exp(-news_take(view) / PERIOD)
    assert taken(view, 10.0) == (pytest.approx(likely**TUNING.caution * SIZE),)


@pytest.mark.parametrize("later", [0.0, 0.2, 0.9])
def test_others_never_take_our_claim_for_less_than_it_is(view, later):
    """What they know of our sends is older: so no two robots find that their own claim is the best."""
    ours = view.streams.known("r1", "robot/r1/camera")
    sent(view, "r1", 9.0)
    before = claim(10.0, ours)
    view.traffic.note_sent(ours, 2, Sent(9.0 + later, 9.0 + later, SIZE, 1.0))
    assert claim(10.0, ours) <= before


@pytest.mark.parametrize("ever", [True, False])
def test_a_stream_of_little_worth_never_holds_a_better_one_back(view, ever):
    """However long it was silent, if it was not always: a new sample gains no more than it is worth itself."""
    ours, theirs = (view.streams.known(robot, f"robot/{robot}/camera") for robot in ("r1", "r2"))
    ours.renew(Generated(9.9, SIZE, 5.0))
    lasts = worthless_from(theirs.information_type.utility)
    sent(view, "r1", 10.0)
    if ever:
        sent(view, "r2", 10.0)
    now = 10.0 + lasts
    assert claim(now + 1000.0, theirs)[0] == pytest.approx(claim(now, theirs)[0])
    view.traffic.note_sent(ours, 2, Sent(now, now, SIZE, 5.0))
    assert claim(now + 0.5 * lasts, ours) > claim(now + 0.5 * lasts, theirs)


def test_two_messages_use_what_each_of_them_does():
    """Of every limit."""
    assert both((1.0, 2.0), (3.0, 0.5)) == (4.0, 2.5)


def test_who_gave_way_counts_for_as_long_as_it_may_be_undecided(view):
    """Two that gave way to a third do not send at once after that; who has the best claim gives way to nobody else."""
    sent(view, "r1", 9.9)
    sent(view, "r2", 9.0)
    news = news_take(view)
    assert taken(view, 10.0 + 2.0 * news) == (0.0,)
    third = view.streams.touch(0.0, "r3", "robot/r3/camera")
    third.matching = True
    for count in range(100):
        third.note_generated(count + 1, Generated(count * PERIOD + 0.5 * news, SIZE, 1.0))
    sent(view, "r3", 8.0)
    assert taken(view, 10.0 + 1.2 * news) == (2 * SIZE,)
    assert judged(view, 10.0 + 1.2 * news)[1] == pytest.approx(10.0 + 1.5 * news)
    assert taken(view, 10.0 + 2.0 * news) == (SIZE,)
    assert judged(view, 10.0 + 2.0 * news)[1] == pytest.approx(10.0 + 2.5 * news)
    assert taken(view, 10.0 + 2.6 * news) == (0.0,)


def test_who_finds_no_room_holds_nobody_up_but_with_the_best_claim(view):
    """All others would wait for what is not sent; for the best claim they leave the room that there is."""
    sent(view, "r1", 9.9)
    sent(view, "r2", 9.0)
    third = view.streams.touch(0.0, "r3", "robot/r3/camera")
    third.matching = True
    for count in range(100):
        third.note_generated(count + 1, Generated(count * PERIOD, 2 * SIZE, 1.0))
    sent(view, "r3", 9.8)
    now = 10.0 + 0.5 * TUNING.deciding
    assert judged(view, now)[0] == (3 * SIZE,)
    assert judged(view, now, free=1.5 * SIZE)[0] == (SIZE,)
    assert judged(view, now, free=0.5 * SIZE)[0] == (SIZE,)


def test_nobody_waits_for_who_gave_way_to_a_sample_whose_time_is_hardly_known(view):
    """It counts for as long as it may come; what becomes of those behind it is known as soon as without it."""
    sent(view, "r1", 9.9)
    sent(view, "r2", 9.0)
    news = news_take(view)
    third = view.streams.touch(0.0, "r3", "robot/r3/camera")
    third.matching = True
    for count in range(100):
        third.note_generated(count + 1, Generated(count * PERIOD, SIZE, 1.0))
    third.schedule.observe(101, 9.9, Rhythm(PERIOD, 9.9, 101, 2.0 * news, 16))
    sent(view, "r3", 8.0)
    assert TUNING.late_part * PERIOD > 1.5 * news
    assert taken(view, 10.0 + 0.5 * news) == (2 * SIZE,)
    assert taken(view, 10.0 + 1.5 * news) == (SIZE,), "the third alone"
    assert taken(view, 10.0 + news + 1.1 * TUNING.late_part * PERIOD) == (0.0,)


def test_who_sent_last_counts_until_all_can_have_heard_of_it(view):
    """Its claim is small then, and another one has given way to it until now and may send next."""
    news = news_take(view)
    sent(view, "r1", 9.9)
    sent(view, "r2", 9.0)
    third = view.streams.touch(0.0, "r3", "robot/r3/camera")
    third.matching = True
    for count in range(100):
        third.note_generated(count + 1, Generated(count * PERIOD + 0.05, SIZE, 1.0))
    sent(view, "r3", 10.0 + 0.9 * news)
    assert taken(view, 10.0 + 1.5 * news) == (SIZE,)
    assert judged(view, 10.0 + 1.5 * news)[1] == pytest.approx(10.0 + 2.9 * news)
    assert taken(view, 10.0 + 3.0 * news) == (0.0,)


def test_a_sample_may_come_later_than_it_is_due(view):
    """By as much as its rhythm is unsure: more, the longer nothing of it was told."""
    sent(view, "r1", 9.9)
    sent(view, "r2", 9.0)
    theirs, late = view.streams.known("r2", "robot/r2/camera"), 10.0 + 1.5 * news_take(view)
    theirs.schedule.observe(101, 9.9, Rhythm(PERIOD, 9.9, 101, 0.0, 16))
    assert taken(view, late) == (0.0,)
    theirs.schedule.observe(102, 9.9, Rhythm(PERIOD, 9.9, 102, 0.5 * news_take(view), 16))
    assert taken(view, late) == (SIZE,)


def test_of_two_that_are_as_long_silent_one_leads(view):
    """Though what each knows of the other is off by a bit: clocks and the wire round."""
    limits, disputes = limits_of(view.specs, 0.02, 2), Disputes(view)
    disputes.advance(10.0, limits, alone=False)
    sent(view, "r1", 9.5)
    sent(view, "r2", 9.5 + 0.5 * TUNING.claim_tolerance)
    assert not Claims(view, disputes).lead(10.0, view.streams.known("r1", "robot/r1/camera"), limits)
    assert taken(view, 10.0 + 0.5 * TUNING.deciding) == (SIZE,)
    view.traffic.note_sent(view.streams.known("r2", "robot/r2/camera"), 2, Sent(9.6, 9.6, SIZE, 1.0))
    assert Claims(view, disputes).lead(10.0, view.streams.known("r1", "robot/r1/camera"), limits)


def test_a_sample_that_was_told_of_while_it_waits_for_room_counts_as_taken(view):
    """The best claim waits for the room that anybody leaves; what it told meanwhile does not say what became of it."""
    sent(view, "r1", 9.9)
    sent(view, "r2", 9.0)
    theirs = view.streams.known("r2", "robot/r2/camera")
    now = 10.0 + 4.0 * news_take(view)
    theirs.note_generated(101, Generated(10.0, SIZE, 1.0))
    assert taken(view, now) == (0.0,)
    assert taken(view, now, grew=now) == (SIZE,)


def test_a_stream_that_never_sent_has_the_claim_of_its_whole_life(view):
    """All know since when it generates, whenever they heard of it first."""
    ours = view.streams.touch(0.0, "r1", "robot/r3/camera")
    theirs = view.streams.touch(0.0, "r2", "robot/r3/camera")
    ours.note_generated(1, Generated(0.1, SIZE, 1.0))
    theirs.note_generated(50, Generated(5.0, SIZE, 1.0), told=Rhythm(0.1, 5.0, 50, 0.001, 16))
    assert theirs.began == pytest.approx(ours.began)


@pytest.mark.parametrize("later", [-0.6, -0.1, 0.1, 0.6])
def test_of_two_streams_that_never_sent_exactly_one_has_the_better_claim(make_specs, later):
    """However much later one of them began, by less than a period or more: else each would wait for the other."""
    taken_by = {}
    for robot, other in (("r1", "r2"), ("r2", "r1")):
        view = SharedView(CoreSettings(robot, f"z-{robot}"), make_specs(window=0.25))
        view.add_peer(0.0, other, f"z-{other}")
        view.subscribers.set_own(("robot/**",))
        for name in (robot, other):
            stream = view.streams.touch(0.0, name, f"robot/{name}/camera")
            stream.matching = True
            began = later * PERIOD if name == "r2" else 0.0
            for count in range(100 if name == "r1" or later > 0 else 101):
                stream.note_generated(count + 1, Generated(began + count * PERIOD, SIZE, 1.0))
        limits, disputes, now = limits_of(view.specs, 0.02, 2), Disputes(view), 99 * PERIOD + later * PERIOD + 0.01
        disputes.advance(now, limits, alone=False)
        ours = view.streams.known(robot, f"robot/{robot}/camera")
        theirs = view.streams.known(other, f"robot/{other}/camera")
        taken_by[robot] = Claims(view, disputes).lead(now, ours, limits)
        assert (claim(now, theirs) < claim(now, ours)) is taken_by[robot]
    assert sorted(taken_by.values()) == [False, True]


@pytest.mark.parametrize(("robot", "size", "use"), [("r2", SIZE, SIZE), ("r0", SIZE, 0.0), ("r2", 10, 0.0)])
def test_of_two_that_have_just_met_the_name_decides_until_digests_tell_of_large_streams(make_specs, robot, size, use):
    """A state tells that there is one, not when it is due."""
    view = SharedView(CoreSettings("r1", "z1"), make_specs(window=0.25))
    view.add_peer(9.0, robot, f"z-{robot}")
    told = (StreamState(1, f"robot/{robot}/camera", "camera", PERIOD, size=size),)
    view.heard_state(9.0, State(robot, f"z-{robot}", "enforce", "", told, ("robot/**",)))
    stream = view.streams.touch(9.0, "r1", "robot/r1/camera")
    for count in range(10):
        stream.note_generated(count + 1, Generated(9.0 + count * PERIOD, SIZE, 1.0))
    assert taken(view, 10.0) == (use,)
    view.traffic.note_sent(
        stream, 1, Sent(9.5, 9.5, SIZE, 1.0)
    )  # who has sent waits for who has not, whatever their names
    assert taken(view, 10.0) == (SIZE if size == SIZE else 0.0,)
    assert taken(view, 9.0 + VIEW.newcomer_time) == (0.0,)
    news = StreamDigest(1, 5, 0, 9.0, 0.0, size, 1.0)
    view.heard_digest(10.0, Digest(robot, tag(f"z-{robot}"), 9.9, streams=(news,)))
    assert taken(view, 10.5) == (0.0,)


@pytest.mark.parametrize("ours", CLAIMING)
def test_a_contested_stream_does_not_wait_for_a_priced_one(view, monkeypatch, ours):
    """That has a room of its own; of two priced ones the claims decide."""
    limits, disputes = limits_of(view.specs, 0.02, 2), Disputes(view)
    disputes.advance(10.0, limits, alone=False)
    stream, weighed = view.streams.known("r1", "robot/r1/camera"), disputes.weighed
    monkeypatch.setattr(
        disputes, "weighed", lambda s: weighed(s)._replace(standing=ours if s is stream else Standing.PRICED)
    )
    sent(view, "r1", 9.9)
    sent(view, "r2", 9.0)
    now = 10.0 + 0.5 * TUNING.deciding
    expected, claims = 0.0 if ours is Standing.CONTESTED else SIZE, Claims(view, disputes)
    assert claims.rivals(now, stream, limits, lambda *_: -math.inf, lambda _: (math.inf,), agreed=False)[0] == (
        expected,
    )
    assert claims.lead(now, stream, limits) is (ours is Standing.CONTESTED)


def test_the_best_claim_may_have_waited_for_the_room_that_opened(view):
    """Its sample is older than news take then; lesser ones do not wait."""
    sent(view, "r1", 9.5)
    sent(view, "r2", 9.0)
    now = 10.05
    assert taken(view, now) == (0.0,)
    assert taken(view, now, grew=now - 0.5 * TUNING.deciding) == (SIZE,)
    assert taken(view, now, grew=now - 2.0 * news_take(view)) == (0.0,)


def test_the_best_claim_takes_room_that_opens_before_it_hears_of_us(view):
    """It waits for it; lesser ones do not, nor does it wait for room that opens later."""
    sent(view, "r1", 9.5)
    sent(view, "r2", 9.0)

    def opens_at(t):
        return lambda now, ahead: t if t <= now + ahead else -math.inf

    assert judged(view, 10.05, grew=opens_at(10.05 + 0.9 * news_take(view)))[0] == (SIZE,)
    assert judged(view, 10.05, grew=opens_at(10.05 + 1.1 * news_take(view)))[0] == (0.0,)


def test_a_stream_leads_whose_claim_is_better_than_those_of_all_large_ones(view):
    """What is small is soon no part of any dispute; a stream without a rhythm waits for nobody's room."""
    limits, disputes = limits_of(view.specs, 0.02, 2), Disputes(view)
    disputes.advance(10.0, limits, alone=False)
    ours, theirs = (view.streams.known(robot, f"robot/{robot}/camera") for robot in ("r1", "r2"))
    sent(view, "r1", 9.0)
    sent(view, "r2", 9.5)
    assert Claims(view, disputes).lead(10.0, ours, limits)
    view.traffic.note_sent(ours, 2, Sent(9.8, 9.8, SIZE, 1.0))
    assert not Claims(view, disputes).lead(10.0, ours, limits)
    theirs.sizes.mean = SIZE / 40
    assert Claims(view, disputes).lead(10.0, ours, limits)
    ours.schedule.assume(0.1, "poisson")
    assert not Claims(view, disputes).lead(10.0, ours, limits)


def test_news_take_as_long_as_most_of_the_last_digests_did(view):
    """They wait for others, and for processors; few are later."""
    before = news_take(view)
    for count in range(20):
        late = 0.03 if count % 2 else 0.0
        view.heard_digest(11.0 + count + late, Digest("r2", tag("z2"), 11.0 + count))
    assert news_take(view) == pytest.approx(before + 0.03, abs=1e-3)


def test_a_claim_grows_by_what_a_sample_ends(make_specs):
    """With `current`; the worth of the sample alone counts otherwise."""
    claims = []
    for aggregation in ("most_recent", "current"):
        spec = f'aggregation = "{aggregation}"\nname = "camera"\nkeys = ["robot/*/camera"]\nutility.kind = "video"\n'
        view = SharedView(CoreSettings("r1", "z1"), make_specs(text=f"[[information_type]]\n{spec}"))
        stream = view.streams.touch(0.0, "r1", "robot/r1/camera")
        stream.note_sent(1, Sent(8.0, 8.0, SIZE, 6.0))
        stream.note_generated(1, Generated(9.9, SIZE, 1.0))
        claims.append(claim(10.0, stream)[0])
    assert claims[1] - claims[0] == pytest.approx(5.0 * 2.0 / SIZE)


def test_claims_of_streams_that_send_as_often_as_is_best_for_both_are_alike(make_specs):
    """With the worth of video that falls by its logarithm it is best to send twice as often what is worth twice."""
    spec = '[[information_type]]\nname = "camera"\nkeys = ["robot/*/camera"]\nutility.kind = "video"\n'
    view, claims = SharedView(CoreSettings("r1", "z1"), make_specs(text=spec)), []
    for scale, ago in ((1.0, 1.0), (2.0, 0.5)):
        stream = view.streams.touch(0.0, "r1", f"robot/{scale}/camera")
        stream.note_sent(1, Sent(10.0 - ago, 10.0 - ago, SIZE, scale))
        stream.note_generated(1, Generated(10.0, SIZE, scale))
        claims.append(claim(10.0, stream)[0])
    assert claims[1] == pytest.approx(claims[0], rel=0.1)


def test_of_who_has_just_been_met_all_copies_count(make_specs):
    """A sample that is small in one of them may not be in three."""
    view = SharedView(CoreSettings("r1", "z1"), make_specs(window=0.25))
    view.add_peer(9.0, "r2", "z-r2")
    told = (StreamState(1, "robot/r2/camera", "camera", PERIOD, size=30),)
    view.heard_state(9.0, State("r2", "z-r2", "enforce", "", told, ("robot/**",)))
    stream = view.streams.touch(9.0, "r1", "robot/r1/camera")
    for count in range(10):
        stream.note_generated(count + 1, Generated(9.0 + count * PERIOD, SIZE, 1.0))
    assert taken(view, 10.0) == (0.0,)
    for receiver in ("x1", "x2", "x3"):
        view.subscribers.set(receiver, ("robot/r2/camera",))
    assert taken(view, 10.0) == (90.0,)
