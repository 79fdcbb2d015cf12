"""What is news of our streams."""

import pytest

from proxy.core.gossip.stream_news import StreamNews
from proxy.core.gossip.tuning import TUNING
from proxy.core.protocol.digest_codec import pack_digest, unpack_digest
from proxy.core.protocol.fixed import rounded
from proxy.core.protocol.messages import Digest
from proxy.core.view.stream import Generated, Sent, Stream
from tests.proxy.core.talk import UNLIMITED


def stream(key="a", scale=1.0, generated=1):
    made = Stream(1, "r1", key, None)
    made.note_generated(generated, Generated(float(generated), 100, scale))
    return made


def waiting(news, streams):
    news.look(0, streams)
    return news.waiting


def test_only_changed_streams_are_told():
    """What was told is not told again until it changes, or somebody new is there."""
    news, camera = StreamNews(), stream()
    silent = Stream(2, "r1", "b", None)
    assert waiting(news, [camera])
    assert [s.generated for s in news.take(0.0, [camera, silent])] == [1]
    assert not waiting(news, [camera, silent])
    assert news.take(0.1, [camera, silent]) == ()
    camera.note_generated(2, Generated(2.0, 100, 1.0))
    assert [s.generated for s in news.take(0.2, [camera])] == [2]
    news.forget()
    assert len(news.take(0.3, [camera])) == 1


def test_what_may_have_been_lost_is_told_again_in_turn():
    """A few streams in each digest, those told longest ago first; it is no news that would hurry a digest."""
    news = StreamNews()
    many = [stream(f"k{number}") for number in range(5)]
    news.take(0.0, many[:3])
    news.take(1.0, many)
    assert not waiting(news, many)
    later = 1.0 + TUNING.refresh_after
    assert [len(news.take(later, many)) for _ in range(4)] == [TUNING.refreshed, TUNING.refreshed, 1, 0]


def test_many_changes_are_told_the_greatest_first():
    """One digest holds 32 streams; the rest follows in the next."""
    news = StreamNews()
    many = [stream(f"k{number}", scale=float(number)) for number in range(40)]
    lefts = [bool(news.take(0.0, many)) and news.left for _ in range(2)]
    assert lefts == [True, False]
    for one in many:
        one.note_generated(2, Generated(2.0, 100, one.newest.scale * (10.0 if one.key == "k39" else 1.0)))
    told = news.take(0.0, many)
    assert len(told) == 32
    assert told[0].scale == 390.0
    assert len(news.take(0.0, many)) == 8


def test_a_stream_is_introduced_once_and_its_rhythm_when_it_is_known():
    """So others know at once when its samples are due."""
    news, camera = StreamNews(), stream()
    assert news.introduces(camera)
    news.take(0.0, [camera])
    assert not news.introduces(camera)
    camera.note_generated(2, Generated(2.0, 100, 1.0))
    assert news.introduces(camera)
    assert [s.period for s in news.take(2.0, [camera], (), (camera.key,))] == [pytest.approx(1.0, rel=1e-3)]
    assert not news.introduces(camera)


def test_a_stream_that_begins_again_is_introduced_anew():
    """Others have heard that it ceased, and look for none of it."""
    news, camera = StreamNews(), stream()
    for number in range(2, 10):
        camera.note_generated(number, Generated(float(number), 100, 1.0))
    news.take(9.0, [camera])
    assert not news.introduces(camera)
    assert not news.value_changed(camera)
    camera.note_generated(10, Generated(20.0, 100, 1.0))
    assert news.introduces(camera)
    assert news.value_changed(camera)
    news.take(20.0, [camera])
    camera.note_generated(11, Generated(21.0, 100, 1.0))
    assert not news.introduces(camera)


def test_that_a_stream_ceased_is_told_once():
    """A little after it is over; what was announced says when it generated last, and that it did not since."""
    news, camera = StreamNews(), stream()
    for number in range(2, 10):
        camera.note_generated(number, Generated(float(number), 100, 1.0))
    assert news.ceasing([camera]) == {}
    news.take(9.0, [camera])
    (ends,) = news.ceasing([camera]).values()
    assert ends > camera.schedule.over_at
    assert [each.generated for each in news.take(ends, [camera], (), (camera.key,))] == [9]
    assert news.ceasing([camera]) == {}


def test_a_value_that_changed_by_a_quarter_is_urgent():
    """Others plan with it."""
    news, camera = StreamNews(), stream(scale=1.0)
    assert news.value_changed(camera)
    news.take(0.0, [camera])
    camera.note_generated(2, Generated(2.0, 100, 1.2))
    assert not news.value_changed(camera)
    camera.note_generated(3, Generated(3.0, 100, 1.5))
    assert news.value_changed(camera)


def test_an_announcement_tells_of_streams_that_sent_something_alone():
    """The rest is news for later."""
    news, sending, silent = StreamNews(), stream("a"), stream("b")
    news.take(0.0, [sending, silent])
    for each in (sending, silent):
        each.note_generated(2, Generated(2.0, 100, 1.0))
    sending.note_sent(1, Sent(2.0, 2.0, 100, 1.0))
    both = {sending.key, silent.key}
    assert [(each.generated, each.forwarded) for each in news.take(2.0, [sending, silent], both)] == [(2, 1)]
    assert news.take(2.0, [sending, silent], both) == ()
    assert waiting(news, [sending, silent])
    assert [(each.generated, each.forwarded) for each in news.take(2.1, [sending, silent])] == [(2, 0)]


def test_others_read_of_a_sample_however_much_it_is_worth(make_specs):
    """Its digest was malformed to all, and so were those after it while the stream was silent."""
    (covering,) = make_specs(text=UNLIMITED.replace("1 + 10 * red", "exp(red)")).types
    worthy = Stream(1, "r1", "robot/r1/camera", covering)
    worthy.note_generated(1, Generated(1.0, 10, rounded(covering.scale({"red": 40.0}))))
    data = pack_digest(Digest("r1", "a1b2c3d4", 1.0, streams=StreamNews().take(1.0, [worthy])))
    assert unpack_digest(data, "r1", "a1b2c3d4").streams[0].scale == worthy.newest.scale


def test_a_digest_has_news_of_no_more_features_than_others_read(make_specs):
    """The rest follows in the next: 32 streams with 32 large numbers each were malformed to all."""
    utility = 'utility = { kind = "python", function = "tests.utility_specs.worths:by_red" }'
    features = "".join(f'features.f{n} = {{ kind = "size" }}\n' for n in range(31))
    text = UNLIMITED.replace('utility = { kind = "video" }', utility).replace("forecast =", features + "forecast =")
    (covering,) = make_specs(text=text).types
    values = dict.fromkeys((name for name, _ in covering.features), 2.0**40)
    news, many = StreamNews(), [Stream(2**31 + n, "r1", f"k{n}", covering) for n in range(32)]
    for each in many:
        each.note_generated(2**40, Generated(1e9, 2**30, 1e14 / 3, values))
    told = [news.take(2.0, many) for _ in range(3)]
    assert sorted(each.id for digest in told for each in digest) == [each.id for each in many]
    for streams in told:
        data = pack_digest(Digest("r1", "a1b2c3d4", 2.0, 2**53, 2**53, streams, state=2**53))
        assert len(data) < TUNING.news_bytes
        assert [s.features for s in unpack_digest(data, "r1", "a1b2c3d4").streams] == [s.features for s in streams]


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
        (news,) = StreamNews().take(1.0, [stream])
        assert news.features == told
