"""When digests go out, and what is in them, within the allowance of the team."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.gossip.digest_budget import (
    FULL,
    HEAD_START,
    MOST_ECHOES,
    MOST_OWED,
    MOST_REFRESHED,
    ORDINARY,
    OVERHEAD,
    REFRESH,
    SAVED,
    SLOW,
    STATES,
    DigestPacer,
)
from proxy.core.protocol.messages import Echo, State, StreamState
from proxy.core.view.stream import Generated, Sent, Stream
from tests.proxy.core.talk import UNLIMITED

SIZE = 40
AHEAD = 5.0


def stream(key="a", scale=1.0, generated=1, kind=None):
    made = Stream(1, "r1", key, kind)
    made.note_generated(generated, Generated(float(generated), 100, scale))
    return made


def echo(peer):
    return Echo(peer, 0.0, 0.0, 0, 0.0)


def pacer_of(rate, robots=1, **rest):
    made = DigestPacer(0.0, **rest)
    made.set_rate(rate, robots, robots)
    return made


@pytest.mark.parametrize(("announcing", "part"), [(False, 1.0), (True, ORDINARY)])
def test_ordinary_news_of_a_robot_stay_within_its_part(announcing, part):
    """An equal one of what announcements leave: over twenty seconds no more, those of the beginning aside."""
    pacer, now, spent, copies = pacer_of(2500.0, robots=5), 0.0, 0, 4
    while now < 20.0:
        now += 0.05
        if announcing:
            pacer.spent(now, 75, copies)
        if pacer.due(now, news=True, copies=copies) <= now:
            pacer.sent(now, SIZE, copies)
            spent += (SIZE + OVERHEAD) * copies
    assert 0.8 * part * 10_000 <= spent <= part * 10_000 + 2000


@given(
    st.integers(1, 6),
    st.lists(st.tuples(st.integers(0, 5), st.booleans(), st.floats(0.0, 0.5), st.integers(20, 300)), max_size=150),
)
def test_in_the_long_run_all_robots_together_are_within_the_rate(robots, wanted):
    """Whoever announces, and whoever tells all: besides what was saved, spent ahead, and one of each that was begun."""
    rate, now, spent, largest = 1000.0, 0.0, 0, 0
    team = [pacer_of(rate, robots, turn=number / robots) for number in range(robots)]
    for who, announces, pause, size in wanted:
        now += pause
        pacer = team[who % robots]
        due = pacer.due_ahead(now, AHEAD) if announces else pacer.due(now, news=True, copies=1)
        if due > now:
            continue
        pacer.sent(now, size, 1, announces=announces)
        for other in team:
            if other is not pacer:
                other.spent(now, size, 1)
        spent += size + OVERHEAD
        largest = max(largest, size + OVERHEAD)
    ordinary = 3 * robots * largest + 100.0 * robots
    assert spent <= rate * (now + FULL + AHEAD) + ordinary + largest


@given(st.lists(st.tuples(st.sampled_from(("digest", "state", "question")), st.integers(1, 3000)), max_size=80))
def test_what_is_paid_for_later_is_within_our_part(sent):
    """Digests and, beside them, states and questions: besides what was saved, and a few of each that were begun."""
    pacer, now, spent, largest = pacer_of(500.0), 0.0, 0, 0
    for kind, size in sent:
        if kind == "digest":
            now = max(now, pacer.due(now, news=True, copies=2))
            pacer.sent(now, size, 2)
        elif kind == "state":
            now = max(now, pacer.state_due(now))
            pacer.owe(now, size, 2)
        else:
            now = max(now, pacer.state_due(now))
            pacer.owe(now, size, 1)
        spent += (size + OVERHEAD) * (1 if kind == "question" else 2)
        largest = max(largest, size + OVERHEAD)
    assert spent <= (1.0 + STATES) * 500.0 * (now + SAVED) + SAVED * 100.0 + 3 * 4 * largest + 500.0


def test_digests_go_on_while_a_state_is_paid_for():
    """With half of our part; another state waits."""
    pacer = pacer_of(1000.0)
    pacer.owe(0.0, 3000, 4)
    before = pacer.state_due(0.0)
    assert before > 20.0
    for number in range(1, 11):
        now = pacer.due(float(2 * number), news=True, copies=4)
        assert now <= 2 * number + 1.0
        pacer.sent(now, SIZE, 4)
    assert pacer.state_due(21.0) <= before


def test_what_was_sent_is_announced_ahead_of_time_by_whom_it_concerns():
    """One robot may use what all do not, but no more of it than so many seconds' worth ahead."""
    pacer, told = pacer_of(1000.0, robots=10), 0
    while pacer.due_ahead(0.0, AHEAD) <= 0.0:
        pacer.sent(0.0, SIZE, 9, announces=True)
        told += 1
    assert AHEAD * 1000.0 <= told * (SIZE + OVERHEAD) * 9 <= (AHEAD + FULL) * 1000.0 + (SIZE + OVERHEAD) * 9
    assert pacer.due_ahead(0.0, AHEAD) < 1.0
    assert pacer.due_ahead(0.0, 0.0) == pytest.approx(AHEAD, rel=0.15)


def test_what_others_tell_is_taken_from_the_same_pool():
    """An announcement waits for it where they have spent as much ahead of time as may be."""
    pacer = pacer_of(1000.0, robots=3)
    pacer.spent(0.0, 5000 - OVERHEAD, 1)
    assert pacer.due_ahead(0.0, AHEAD) <= 0.0
    pacer.spent(0.0, 500 - OVERHEAD, 2)
    assert pacer.due_ahead(0.0, AHEAD) == pytest.approx(1.0)


def test_nobody_is_silenced_by_what_others_tell():
    """Whatever they say, ordinary news go out every second or two, and announcements when it is over."""
    pacer, told = pacer_of(1000.0, robots=3), []
    for step in range(1000):
        now = 0.02 * step
        pacer.spent(now, 8000, 2)
        if pacer.due(now, news=True, copies=2) <= now:
            pacer.sent(now, SIZE, 2)
            told.append(now)
    assert len(told) >= 12
    assert max(after - before for before, after in pairwise(told)) <= 2.0 * SLOW + 0.021
    assert pacer.due_ahead(20.0, AHEAD) <= 20.0 + MOST_OWED - AHEAD


def test_two_robots_that_waited_for_the_allowance_do_not_tell_at_the_same_moment():
    """They begin with other turns, and each digest moves its robot's on."""
    one, other = (pacer_of(1000.0, robots=2, turn=turn) for turn in (0.1, 0.6))
    for _ in range(4):
        for pacer in (one, other):
            pacer.spent(0.0, 300, 1)
            pacer.sent(0.0, SIZE, 1)
        due = [pacer.due(0.05, news=True, copies=1) for pacer in (one, other)]
        assert abs(due[0] - due[1]) > 0.01


def test_without_news_a_digest_goes_out_slowly():
    """Once a second, so that clocks and counts stay known."""
    pacer = pacer_of(1e6)
    pacer.sent(5.0, SIZE, 1)
    assert pacer.due(5.1, news=False, copies=1) == pytest.approx(5.0 + SLOW)


def test_only_changed_streams_are_told():
    """What was told is not told again until it changes, or somebody new is there."""
    pacer, camera = DigestPacer(0.0), stream()
    silent = Stream(2, "r1", "b", None)
    assert pacer.has_news([camera])
    assert [s.generated for s in pacer.changed(0.0, [camera, silent])] == [1]
    assert not pacer.has_news([camera, silent])
    assert pacer.changed(0.1, [camera, silent]) == ()
    camera.note_generated(2, Generated(2.0, 100, 1.0))
    assert [s.generated for s in pacer.changed(0.2, [camera])] == [2]
    pacer.forget()
    assert len(pacer.changed(0.3, [camera])) == 1


def test_what_may_have_been_lost_is_told_again_in_turn():
    """A few streams in each digest, those told longest ago first; it is no news that would hurry a digest."""
    pacer = DigestPacer(0.0)
    many = [stream(f"k{number}") for number in range(5)]
    pacer.changed(0.0, many[:3])
    pacer.changed(1.0, many)
    assert not pacer.has_news(many)
    later = 1.0 + REFRESH
    assert [len(pacer.changed(later, many)) for _ in range(4)] == [MOST_REFRESHED, MOST_REFRESHED, 1, 0]


def test_many_changes_are_told_the_greatest_first():
    """One digest holds 32 streams; the rest follows in the next."""
    pacer = DigestPacer(0.0)
    many = [stream(f"k{number}", scale=float(number)) for number in range(40)]
    pacer.changed(0.0, many)
    pacer.changed(0.0, many)
    for one in many:
        one.note_generated(2, Generated(2.0, 100, one.newest.scale * (10.0 if one.key == "k39" else 1.0)))
    told = pacer.changed(0.0, many)
    assert len(told) == 32
    assert told[0].scale == 390.0
    assert len(pacer.changed(0.0, many)) == 8


def test_a_value_that_changed_by_a_quarter_is_urgent():
    """Others plan with it."""
    pacer, camera = DigestPacer(0.0), stream(scale=1.0)
    assert pacer.value_changed(camera)
    pacer.changed(0.0, [camera])
    camera.note_generated(2, Generated(2.0, 100, 1.2))
    assert not pacer.value_changed(camera)
    camera.note_generated(3, Generated(3.0, 100, 1.5))
    assert pacer.value_changed(camera)


def test_each_peer_is_echoed_about_once_a_second():
    """If the allowance is large."""
    pacer = pacer_of(1e6)
    assert [e.peer for e in pacer.echoes(1.0, [echo("a"), echo("b")], 2)] == ["a", "b"]
    assert pacer.echoes(1.9, [echo("a")], 2) == ()
    assert {e.peer for e in pacer.echoes(2.0, [echo("a"), echo("b")], 2)} == {"a", "b"}


def test_of_many_peers_a_few_are_echoed_in_turn():
    """As many as a digest holds, and as a quarter of the allowance pays for."""
    peers = [echo(f"p{number:02}") for number in range(40)]
    pacer = pacer_of(1e6)
    told = [e.peer for now in (1.0, 1.1, 1.2, 1.3, 1.4) for e in pacer.echoes(now, peers, 40)]
    assert told == [e.peer for e in peers]
    assert len(told) == 5 * MOST_ECHOES
    poor = pacer_of(100.0)
    told = [e.peer for now in range(1, 101) for e in poor.echoes(float(now), peers[:4], 4)]
    assert 100.0 * 100.0 / 4.0 * 0.8 <= len(told) * 23 * 4 - HEAD_START <= 100.0 * 100.0 / 4.0 * 1.1
    assert all(abs(told.count(e.peer) - len(told) / 4) <= 1 for e in peers[:4])
    broadcast = pacer_of(100.0)
    assert len([e for now in range(1, 101) for e in broadcast.echoes(float(now), peers[:4], 1)]) > 3 * len(told)


@pytest.mark.parametrize("follows", [True, False])
def test_where_limits_follow_the_channel_digests_go_on_though_all_owe_for_what_was_told(follows):
    """They tell of it. Else nobody plans with them where each has its part, and they wait until it is paid."""
    pacer = DigestPacer(0.0)
    pacer.set_rate(1_000.0, 4, 4, follows=follows)
    pacer.follow(1.0, splits=True, quiet=False, begins=False, window=0.5)
    pacer.spent(1.0, 1_500, 4)
    assert (pacer.due(4.0, news=True, copies=4) <= 6.0) is follows


def test_a_robot_that_begins_has_room_for_a_few_echoes():
    """Before it knows how many there are, too: without any nobody knows how long the way is."""
    pacer = DigestPacer(0.0)
    pacer.due(0.1, news=False, copies=1)
    pacer.set_rate(1_000.0, 11, 11)
    assert pacer.affordable_echoes(0.2, 10) == 2


def test_an_announcement_tells_of_streams_that_sent_something_alone():
    """The rest is news for later."""
    pacer, sending, silent = DigestPacer(0.0), stream("a"), stream("b")
    pacer.changed(0.0, [sending, silent])
    for each in (sending, silent):
        each.note_generated(2, Generated(2.0, 100, 1.0))
    sending.note_sent(1, Sent(2.0, 2.0, 100, 1.0))
    both = {sending.key, silent.key}
    assert [(news.generated, news.forwarded) for news in pacer.changed(2.0, [sending, silent], both)] == [(2, 1)]
    assert pacer.changed(2.0, [sending, silent], both) == ()
    assert pacer.has_news([sending, silent])
    assert [(news.generated, news.forwarded) for news in pacer.changed(2.1, [sending, silent])] == [(2, 0)]


def test_an_announcement_leaves_out_what_is_as_usual(make_specs):
    """The size where it is the typical one and nothing follows it, the value where it is that of its type."""
    (camera,) = make_specs().types
    pacer, state = DigestPacer(0.0), State("r1", "z1", "", "", (StreamState(1, "a", "camera", 0.5, size=100),))

    def announced(**changes):
        made = stream(kind=camera)
        made.note_generated(2, made.newest._replace(t_gen=2.0, **changes))
        (news,) = pacer.usual(pacer.changed(2.0, [made]), state)
        return news.size, news.scale, news.features

    assert announced() == (0, -1.0, ())
    assert announced(size=101) == (101, -1.0, ())
    assert announced(scale=2.0) == (100, 2.0, ())
    assert announced(features={"red": 0.25}) == (0, -1.0, ())


def test_features_are_told_where_others_need_them(make_specs):
    """Only a `python` utility needs more than the scale."""
    for utility, told in (
        ('{ kind = "python", function = "tests.utility_specs.worths:by_red" }', (0.25,)),
        ('{ kind = "video" }', ()),
    ):
        text = UNLIMITED.replace('utility = { kind = "video" }', f"utility = {utility}")
        (covering,) = make_specs(text=text).types
        stream = Stream(1, "r1", "robot/r1/camera", covering)
        stream.note_generated(1, Generated(1.0, 10, 2.0, {"red": 0.25}))
        (news,) = DigestPacer(0.0).changed(1.0, [stream])
        assert news.features == told


def test_the_first_agreement_may_take_what_was_saved():
    """Until the team has begun; what is left of it is not spent later."""
    pacer = pacer_of(1000.0, robots=10, saved=15.0)
    pacer.follow(0.0, splits=True, quiet=False, begins=True, window=2.0)
    for _ in range(20):
        assert pacer.due_ahead(0.0, 0.0) == 0.0
        pacer.sent(0.0, SIZE, 9, announces=True)
    pacer.follow(5.0, splits=True, quiet=False, begins=False, window=2.0)
    pacer.sent(5.0, SIZE, 9, announces=True)
    assert pacer.due_ahead(5.0, 0.0) > 5.0


@given(st.lists(st.floats(0.0, 0.6), min_size=1, max_size=60), st.integers(20, 90))
def test_where_each_has_its_part_no_window_holds_more_than_its_allowance(pauses, size):
    """Of news of parts and of ordinary ones together: parts leave the limit no more than that."""
    pacer, now, window, told = pacer_of(1000.0, robots=4, turn=0.3), 10.0, 2.0, []
    pacer.follow(now, splits=True, quiet=False, begins=False, window=window)
    pacer.sent(now, size, 3)
    pacer.spent(now, size, 3)
    told += [(now, (size + OVERHEAD) * 3)] * 2
    for place, pause in enumerate(pauses):
        now += pause
        aside = place % 2 == 0
        due = pacer.due_in_turn(now, -math.inf, 5.0, 3) if aside else pacer.due(now, news=True, copies=3)
        if due <= now:
            pacer.sent(now, size, 3, announces=aside)
            told.append((now, (size + OVERHEAD) * 3))
        assert sum(cost for t, cost in told if t > now - window) <= 1000.0 * window


def test_where_robots_announce_ordinary_news_wait_until_the_window_has_room_for_them():
    """Not for ever: who announces much does not take the place of all other news. Announcements do not wait."""
    pacer = pacer_of(1000.0, robots=4)
    pacer.follow(0.0, splits=False, quiet=False, begins=False, window=0.5)
    assert pacer.due(10.0, news=True, copies=3) == 10.0
    for k in range(60):
        pacer.spent(10.0 + 0.1 * k, 68, 1)
    assert pacer.due_ahead(16.0, 5.0) == 16.0
    assert pacer.due(16.0, news=True, copies=3) == 16.0
    pacer.sent(16.0, SIZE, 3)
    pacer.spent(16.0, 300, 1)
    assert 16.0 < pacer.due(16.0, news=True, copies=3) <= 16.0 + 2.0 * SLOW


def test_who_could_afford_nothing_for_long_waits_for_room_all_the_same():
    """One short window at most: else all that may tell something do at one moment."""
    pacer = pacer_of(1000.0, robots=4)
    pacer.follow(0.0, splits=False, quiet=False, begins=False, window=0.5)
    pacer.due(10.0, news=True, copies=3)
    pacer.sent(10.0, 300, 3)
    affordable = next(t for t in map(float, np.arange(10.0, 40.0, 0.01)) if pacer.due(t, news=True, copies=3) <= t)
    assert affordable > 10.0 + 2.0 * SLOW
    pacer.spent(affordable, 450, 1)
    assert affordable < pacer.due(affordable, news=True, copies=3) <= affordable + 2.0 * 0.5


def test_robots_with_news_of_parts_do_not_speak_at_one_moment():
    """Each waits for a bit more of the allowance than the last one."""
    due = []
    for turn in (0.0, 0.4, 0.8):
        pacer = pacer_of(1000.0, robots=4, turn=turn)
        pacer.follow(0.0, splits=True, quiet=False, begins=False, window=2.0)
        pacer.spent(0.0, 400, 3)
        due.append(pacer.due_in_turn(0.0, -math.inf, 0.5, 3))
    assert due == sorted(set(due))


def test_digests_that_go_to_all_at_once_are_paid_for_once():
    """On the air a newcomer has what one digest takes, not one for each robot."""
    spent = {}
    for copies in (1, 50):
        pacer, now = DigestPacer(0.0), 0.0
        pacer.set_rate(5_000.0, 51, copies)
        spent[copies] = 0
        while now < 5.0:
            if pacer.due(now, news=True, copies=copies) <= now:
                pacer.sent(now, 200, copies)
                spent[copies] += (200 + OVERHEAD) * copies
            now += 0.01
    assert spent[1] <= 5.0 * 5_000.0 / 51 + 4 * (200 + OVERHEAD)


def test_a_large_team_tells_in_turn():
    """Of fifty that begin to split at one moment no two tell at once."""
    due = []
    for number in range(50):
        pacer = DigestPacer(0.0, number / 50)
        pacer.set_rate(5_000.0, 50, 49)
        pacer.follow(0.0, splits=True, quiet=True, begins=False, window=0.5)
        due.append(pacer.due(0.0, news=True, copies=49))
    assert min(after - before for before, after in pairwise(sorted(due))) > 0.5


def test_robots_that_answer_one_do_so_within_the_allowance():
    """One after the other, in the time that it has room for all; who passes a slot on does not wait."""
    due, cost = [], 4 * (SIZE + OVERHEAD)
    for number in range(10):
        pacer = pacer_of(1_000.0, robots=10, turn=number / 10)
        pacer.follow(0.0, splits=True, quiet=False, begins=False, window=2.0)
        pacer.sent(0.0, SIZE, 4, announces=True)
        due.append(pacer.due_in_turn(20.0, 20.0, 0.5, 4) - 20.0)
        assert pacer.due_in_turn(20.0, -math.inf, 0.5, 4) == 20.0
    late = sorted(due)
    assert min(after - before for before, after in pairwise(late)) > cost / 1_000.0
    assert late[-1] - late[0] < 2.0 * 10 * cost / 1_000.0
