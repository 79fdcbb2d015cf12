"""What of a sample the core is told."""

import pytest
import zenoh

from proxy.bridge.sample import Held, Parcel, generated, origin_of, priority_of, publish, wall_of
from tests.proxy.nodes import Heard, free_endpoint, plain_session, wait_matching
from tests.waiting import wait_until


def stamp(seconds):
    return zenoh.Timestamp(zenoh.NTP64(int(seconds), round(seconds % 1 * 1e9)), b"\xab")


def test_a_timestamp_holds_a_time_and_an_id():
    """The id is hex, the time is seconds since 1970."""
    assert origin_of(stamp(1000.25)) == "ab"
    assert wall_of(stamp(1000.25)) == pytest.approx(1000.25, abs=1e-6)


@pytest.mark.parametrize(
    ("seconds", "expected"),
    [(None, 50.0), (999.4, 49.4), (998.9, 50.0), (1000.9, 50.0), (1001.1, 50.0)],
)
def test_generation_time_is_the_timestamps_when_it_is_plausible(seconds, expected):
    """Within the second before the arrival it counts, otherwise (or without one) the arrival: no sample comes early."""
    given = None if seconds is None else stamp(seconds)
    assert generated(given, now=50.0, wall=1000.0) == pytest.approx(expected, abs=1e-6)


def test_priorities_have_zenohs_numbers():
    """From 1, real time, to 7, background."""
    names = ("REAL_TIME", "INTERACTIVE_HIGH", "INTERACTIVE_LOW", "DATA_HIGH", "DATA", "DATA_LOW", "BACKGROUND")
    with plain_session("peer") as session:
        heard = Heard(session, "p")
        for name in names:
            session.put("p", name, priority=getattr(zenoh.Priority, name))
        wait_until(lambda: len(heard.samples) == 7, what="all priorities")
        assert [priority_of(sample) for sample in heard.samples] == list(range(1, 8))


def test_what_is_held_apart_leaves_as_it_came():
    """Nothing of a sample changes by it; a large one stays where it is, and nothing is copied twice."""
    with plain_session("peer", listen=(endpoint := free_endpoint(),)) as session:
        heard, came = Heard(session, "p"), Heard(session, "q")
        with plain_session("client", connect=(endpoint,)) as app:
            # Of one kind: else one may overtake another.
            quality = {"priority": zenoh.Priority.DATA_LOW, "congestion_control": zenoh.CongestionControl.BLOCK}
            app.put("p", "small", encoding="text/plain;of a kind", express=True, attachment=b"beside", **quality)
            app.delete("p", **quality)
            app.put("p", bytes(40_000), **quality)
            wait_until(lambda: len(heard.samples) == 3, what="the samples")
            wait_matching(app, "q")
            held = [Held(sample, None, "p", len(sample.payload), None) for sample in heard.samples]
            apart = [each.apart for each in held]
            assert [isinstance(each.sample, Parcel) for each in apart] == [True, True, False]
            assert [each.apart for each in apart] == apart
            for each in apart:
                publish(app, each.sample, None, "q", source=None)
            wait_until(lambda: len(came.samples) == 3, what="the samples anew")
        fields = [*(name for name in Parcel._fields if name != "key_expr"), "source_info"]
        for before, after in zip(heard.samples, came.samples, strict=True):
            assert [getattr(before, name) for name in fields] == [getattr(after, name) for name in fields]
