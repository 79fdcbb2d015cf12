"""When digests go out, within the allowance."""

import pytest

from proxy.core.codec import pack_digest
from proxy.core.digests import OVERHEAD, SLOW, DigestPacer
from proxy.core.limits import LEAST_DIGEST
from proxy.core.stream import Generated, Stream
from proxy.core.wire import Digest, Echo
from tests.proxy.core.talk import UNLIMITED


def digest(*streams, echoes=()):
    return Digest("r1", "z-r1", 0.0, 0, 0, 0, streams, (), echoes)


def stream(key="a", scale=1.0, generated=1):
    made = Stream(1, "r1", key, None)
    made.note_generated(generated, Generated(float(generated), 100, scale))
    return made


def test_a_robot_with_urgent_news_stays_within_its_rate():
    """Over ten seconds no more bytes go out than allowed, the first second's worth aside."""
    pacer, now, spent, copies = DigestPacer(0.0), 0.0, 0, 4
    pacer.set_rate(1000.0)
    while now < 10.0:
        now = max(now + 0.001, pacer.due(now, urgent=True, news=True))
        pacer.sent(now, digest(), copies)
        spent += max(len(pack_digest(digest())) + OVERHEAD, LEAST_DIGEST) * copies
    assert 8_000 <= spent <= 11_500


def test_ordinary_news_leaves_room_for_urgent_news():
    """After a burst, urgent news may go out before ordinary news."""
    pacer = DigestPacer(0.0)
    pacer.set_rate(1000.0)
    for _ in range(8):
        pacer.sent(0.0, digest(), 4)
    assert pacer.due(0.0, urgent=True, news=True) < pacer.due(0.0, urgent=False, news=True)


def test_without_news_a_digest_goes_out_slowly():
    """Once a second, so that clocks and counts stay known."""
    pacer = DigestPacer(0.0)
    pacer.set_rate(1e6)
    pacer.sent(5.0, digest(), 1)
    assert pacer.due(5.1, urgent=False, news=False) == pytest.approx(5.0 + SLOW)


def test_only_changed_streams_are_told():
    """What was told is not told again until it changes, or somebody new is there."""
    pacer, camera = DigestPacer(0.0), stream()
    silent = Stream(2, "r1", "b", None)
    assert pacer.has_news([camera])
    assert [s.generated for s in pacer.changed([camera, silent])] == [1]
    assert not pacer.has_news([camera, silent])
    assert pacer.changed([camera, silent]) == ()
    camera.note_generated(2, Generated(2.0, 100, 1.0))
    assert [s.generated for s in pacer.changed([camera])] == [2]
    pacer.forget()
    assert len(pacer.changed([camera])) == 1


def test_many_changes_are_told_the_greatest_first():
    """One digest holds 32 streams; the rest follows in the next."""
    pacer = DigestPacer(0.0)
    many = [stream(f"k{number}", scale=float(number)) for number in range(40)]
    pacer.changed(many)
    pacer.changed(many)
    for one in many:
        one.note_generated(2, Generated(2.0, 100, one.newest.scale * (10.0 if one.key == "k39" else 1.0)))
    told = pacer.changed(many)
    assert len(told) == 32
    assert told[0].scale == 390.0
    assert len(pacer.changed(many)) == 8


def test_a_value_that_changed_by_a_quarter_is_urgent():
    """Others plan with it."""
    pacer, camera = DigestPacer(0.0), stream(scale=1.0)
    assert pacer.value_changed(camera)
    pacer.changed([camera])
    camera.note_generated(2, Generated(2.0, 100, 1.2))
    assert not pacer.value_changed(camera)
    camera.note_generated(3, Generated(3.0, 100, 1.5))
    assert pacer.value_changed(camera)


def test_echoes_go_out_about_once_a_second():
    """They are the larger part of a digest, and need not be in each."""
    pacer = DigestPacer(0.0)
    assert pacer.full(0.0)
    pacer.sent(0.0, digest(echoes=(Echo("z", 0.0, 0.0, 0, 0.0),)), 1)
    assert not pacer.full(0.9)
    assert pacer.full(1.0)


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
        (news,) = DigestPacer(0.0).changed([stream])
        assert news.features == told
