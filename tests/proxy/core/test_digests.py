"""When digests go out, and what is in them, within the allowance."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.digests import (
    MOST_ECHOES,
    MOST_GRANTS,
    MOST_REFRESHED,
    OVERHEAD,
    REFRESH,
    SAVED,
    SLOW,
    DigestPacer,
)
from proxy.core.limits import LEAST_DIGEST
from proxy.core.stream import Generated, Stream
from proxy.core.wire import Echo, Grant
from tests.proxy.core.talk import UNLIMITED

SIZE = 40


def stream(key="a", scale=1.0, generated=1):
    made = Stream(1, "r1", key, None)
    made.note_generated(generated, Generated(float(generated), 100, scale))
    return made


def echo(peer):
    return Echo(peer, 0.0, 0.0, 0, 0.0)


def test_a_robot_with_urgent_news_stays_within_its_rate():
    """Over ten seconds no more bytes go out than allowed, the first second's worth aside."""
    pacer, now, spent, copies = DigestPacer(0.0), 0.0, 0, 4
    pacer.set_rate(1000.0)
    while now < 10.0:
        now = max(now + 0.001, pacer.due(now, urgent=True, news=True, copies=copies))
        pacer.sent(now, SIZE, copies)
        spent += max(SIZE + OVERHEAD, LEAST_DIGEST) * copies
    assert 8_000 <= spent <= 11_500


@given(st.lists(st.tuples(st.sampled_from(("digest", "state", "question")), st.integers(1, 3000)), max_size=80))
def test_in_the_long_run_everything_is_within_the_rate(sent):
    """Digests, states and questions together: besides what was saved, and one of each that was begun."""
    pacer, now, spent, largest = DigestPacer(0.0), 0.0, 0, 0
    pacer.set_rate(500.0)
    for kind, size in sent:
        if kind == "digest":
            now = max(now, pacer.due(now, urgent=True, news=True, copies=2))
            pacer.sent(now, size, 2)
        elif kind == "state":
            now = max(now, pacer.state_due(now))
            pacer.owe(now, size, 2)
        else:
            now = max(now, pacer.state_due(now))
            pacer.owe(now, size, 1)
        spent += max(size + OVERHEAD, LEAST_DIGEST) * 2
        largest = max(largest, size + OVERHEAD)
    assert spent <= 500.0 * (now + SAVED) + 3 * 4 * max(largest, LEAST_DIGEST) + 500.0


def test_digests_go_on_while_a_state_is_paid_for():
    """With half of the allowance; another state waits."""
    pacer = DigestPacer(0.0)
    pacer.set_rate(1000.0)
    pacer.owe(0.0, 6000, 4)
    before = pacer.state_due(0.0)
    assert before > 20.0
    for number in range(1, 11):
        pacer.sent(float(number), SIZE, 4)
    assert pacer.due(10.0, urgent=True, news=True, copies=4) <= 11.0
    assert pacer.state_due(10.0) <= before


def test_ordinary_news_leaves_room_for_urgent_news():
    """After a burst, urgent news may go out before ordinary news."""
    pacer = DigestPacer(0.0)
    pacer.set_rate(1000.0)
    for _ in range(8):
        pacer.sent(0.0, SIZE, 4)
    urgent, ordinary = (pacer.due(0.0, urgent=urgent, news=True, copies=4) for urgent in (True, False))
    assert urgent < ordinary


@given(st.integers(0, 2), st.integers(LEAST_DIGEST, 500))
def test_after_ordinary_news_as_many_urgent_ones_can_follow_as_are_spared(spare, size):
    """They need not wait for the allowance."""
    pacer = DigestPacer(0.0)
    pacer.set_rate(100.0)
    pacer.sent(0.0, size, 1)
    now = pacer.due(0.0, urgent=False, news=True, copies=1, spare=spare) + 1e-6
    for _ in range(1 + spare):
        assert pacer.due(now, urgent=True, news=True, copies=1) <= now
        pacer.sent(now, size, 1)


def test_without_news_a_digest_goes_out_slowly():
    """Once a second, so that clocks and counts stay known."""
    pacer = DigestPacer(0.0)
    pacer.set_rate(1e6)
    pacer.sent(5.0, SIZE, 1)
    assert pacer.due(5.1, urgent=False, news=False, copies=1) == pytest.approx(5.0 + SLOW)


def test_a_digest_that_will_be_small_does_not_wait_for_what_the_last_one_took():
    """One to all is much larger than one to a single robot."""
    pacer = DigestPacer(0.0)
    pacer.set_rate(100.0)
    pacer.sent(0.0, 300, 1)
    small, alike = (pacer.due(0.0, urgent=False, news=True, copies=1, size=size) for size in (LEAST_DIGEST, None))
    assert small < alike - 4.0


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
    pacer = DigestPacer(0.0)
    pacer.set_rate(1e6)
    assert [e.peer for e in pacer.echoes(1.0, [echo("a"), echo("b")], 2)] == ["a", "b"]
    assert pacer.echoes(1.9, [echo("a")], 2) == ()
    assert {e.peer for e in pacer.echoes(2.0, [echo("a"), echo("b")], 2)} == {"a", "b"}


def test_of_many_peers_a_few_are_echoed_in_turn():
    """As many as a digest holds, and as a quarter of the allowance pays for."""
    peers = [echo(f"p{number:02}") for number in range(40)]
    pacer = DigestPacer(0.0)
    pacer.set_rate(1e6)
    told = [e.peer for now in (1.0, 1.1, 1.2, 1.3, 1.4) for e in pacer.echoes(now, peers, 40)]
    assert told == [e.peer for e in peers]
    assert len(told) == 5 * MOST_ECHOES
    poor = DigestPacer(0.0)
    told = [e.peer for now in range(1, 101) for e in poor.echoes(float(now), peers[:4], 4)]
    assert 100.0 * 100.0 / 4.0 * 0.8 <= len(told) * 23 * 4 <= 100.0 * 100.0 / 4.0 * 1.1
    assert all(abs(told.count(e.peer) - len(told) / 4) <= 1 for e in peers[:4])
    broadcast = DigestPacer(0.0)
    assert len([e for now in range(1, 101) for e in broadcast.echoes(float(now), peers[:4], 1)]) > 3 * len(told)


def test_grants_are_told_to_whom_they_concern_the_first_ones_first():
    """Each once, for one that gets lost is lent to nobody else; a digest for all tells those of all."""
    pacer = DigestPacer(0.0)
    early, late = Grant("a", 1.0, 2.0, (10,)), Grant("b", 1.5, 2.0, (10,))
    assert pacer.addressee([late, early]) == "a"
    assert pacer.grants("b") == (late,)
    assert pacer.addressee([late, early]) == "a"
    assert pacer.grants("") == (early,)
    assert pacer.addressee([late, early]) == ""
    assert pacer.grants("") == ()
    assert (pacer.addressee([late, early], 2), pacer.again) == ("a", True)
    assert pacer.grants("a", 2) == (early,)
    many = [Grant(f"p{number:02}", 0.0, float(number), (10,)) for number in range(60)]
    assert pacer.addressee(many) == "p00"
    assert len(pacer.grants("")) == MOST_GRANTS


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
