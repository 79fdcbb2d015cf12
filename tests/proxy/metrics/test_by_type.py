"""Counts by information type: they never sink."""

from proxy.metrics.by_type import ByType
from tests.proxy.metrics.statuses import status, stream


def test_streams_of_a_type_are_added_up():
    """Those of other robots are counted by these."""
    streams = [stream("a", generated=3, forwarded=2), stream("b", generated=4, forwarded=4), stream("c", "map")]
    theirs = stream("d", robot="r2", generated=9)
    assert ByType().take(status(streams=[*streams, theirs])) == {
        "pose": {"streams": 2, "generated": 7, "by_reason": {"forwarded": 6}},
        "map": {"streams": 1, "generated": 0, "by_reason": {}},
    }


def test_the_next_look_adds_what_is_new():
    """However often it is looked, each sample counts once."""
    by_type = ByType()
    by_type.take(status(streams=[stream(generated=3, forwarded=2)]))
    by_type.take(status(streams=[stream(generated=3, forwarded=2)]))
    taken = by_type.take(status(streams=[stream(generated=5, forwarded=2, dropped=1)]))
    assert taken["pose"] == {"streams": 1, "generated": 5, "by_reason": {"forwarded": 2, "dropped": 1}}


def test_a_stream_that_is_forgotten_leaves_its_counts():
    """A counter that sank would look as if the daemon had been restarted."""
    by_type = ByType()
    by_type.take(status(streams=[stream(generated=3, forwarded=2)]))
    assert by_type.take(status())["pose"] == {"streams": 0, "generated": 3, "by_reason": {"forwarded": 2}}
    back = by_type.take(status(streams=[stream(generated=1, forwarded=1)]))
    assert back["pose"] == {"streams": 1, "generated": 4, "by_reason": {"forwarded": 3}}


def test_a_stream_that_was_forgotten_between_two_looks_begins_anew():
    """Its counts are less than they were."""
    by_type = ByType()
    by_type.take(status(streams=[stream(generated=3, forwarded=2)]))
    back = by_type.take(status(streams=[stream(generated=1, forwarded=1)]))
    assert back["pose"] == {"streams": 1, "generated": 4, "by_reason": {"forwarded": 3}}


def test_another_type_takes_a_stream_over_with_what_comes_from_then_on():
    """What was counted for the type before stays there."""
    by_type = ByType()
    by_type.take(status(streams=[stream(generated=3, forwarded=3)]))
    assert by_type.take(status(streams=[stream(type_="map", generated=5, forwarded=5)])) == {
        "pose": {"streams": 0, "generated": 3, "by_reason": {"forwarded": 3}},
        "map": {"streams": 1, "generated": 2, "by_reason": {"forwarded": 2}},
    }
