"""Cadences: how often a stream sends that may send so much in every window, and for how long its samples wait."""

from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner import Exponential, Linear
from proxy.core.cadence import DENSE, LEAST_PATIENCE, PARTS, Cadences, cadences_for

WINDOW = 2.5


def cadences(utility, latency=0.0, period=1.0):
    return cadences_for(utility, latency, period, round(PARTS * WINDOW / period))


@settings(max_examples=25, deadline=None)
@given(period=st.floats(0.4, 6.0), fade=st.floats(0.01, 1.0), latency=st.floats(0.0, 2.0))
def test_more_slots_are_never_worth_less_and_never_more_than_all_samples(period, fade, latency):
    """With as many as a window has samples, each is sent at once."""
    *fewer, everything = cadences(Exponential(1.0, 1.0 / fade), latency, period)
    rates = [each.rate for each in (*fewer, everything)]
    assert all(more >= 0.95 * less for less, more in pairwise(rates))
    assert everything.patience == 0.0
    assert max(rates) <= 1.02 * everything.rate


@pytest.mark.parametrize(("slope", "waits"), [(0.7, False), (0.05, True)])
def test_samples_wait_for_a_slot_where_they_fade_slowly(slope, waits):
    """One message in every 2.5 s, of samples each second: each third one at once, or half of them late."""
    one = cadences(Linear(1.0, slope), latency=1.0)[0]
    assert (one.patience > 0.0) == waits
    at_once = float(Linear(1.0, slope).integral(1.0, 4.0)) / 3.0
    assert one.rate == pytest.approx(at_once) if not waits else one.rate > at_once


def test_a_stream_whose_samples_come_when_its_slot_is_free_sends_that_often():
    """Nothing waits, and nothing is lost."""
    (one,) = cadences(Linear(1.0, 0.1), latency=1.0, period=WINDOW)
    assert one.patience == 0.0
    assert one.rate == pytest.approx(float(Linear(1.0, 0.1).integral(1.0, 1.0 + WINDOW)) / WINDOW)


def talking(make_talk, period):
    """The view of a robot with one stream, which another one wants, the stream, and the time [s]."""
    talk = make_talk(settle=0.0)
    for number in range(6):
        talk.publish(0.1 + period * number)
    talk.want(6.0 * period)
    (stream,) = talk.core.view.own()
    return talk.core.view, stream, 6.0 * period


def test_patience_goes_by_how_many_messages_fit_into_what_is_held(make_talk):
    """Where nothing fits nobody can say."""
    view, stream, now = talking(make_talk, 1.0)
    known, limits = Cadences(view), make_talk(settle=0.0).core.gate.limits
    window = limits[0].window
    by_count = known.of(now, stream, window)
    use = tuple(limit.measure.use(stream.newest.size, 1, own=True) for limit in limits)
    held = [1.5 * each for each in use]
    assert known.patience(now, stream, limits, use, held) == LEAST_PATIENCE + by_count[0].patience
    assert known.patience(now, stream, limits, use, [0.5 * each for each in use]) is None


def test_what_is_known_of_a_stream_stays_until_it_changes(make_talk):
    """Another window is another matter; no more streams are remembered than there may be."""
    view, stream, now = talking(make_talk, 1.0)
    known = Cadences(view)
    first = known.of(now, stream, WINDOW)
    assert known.of(now, stream, WINDOW) is first
    assert len(known.of(now, stream, 2.0 * WINDOW)) == 2 * len(first) - 1


def test_what_samples_seem_to_take_for_a_while_changes_little(make_talk, monkeypatch):
    """Some waited for a slot, and receivers take part of that for the way; where it is so for good, it counts."""
    view, stream, now = talking(make_talk, 1.0)
    known, audience = Cadences(view), view.audiences.of(now, stream)
    before = known.of(now, stream, WINDOW)[0].rate
    monkeypatch.setattr(view.audiences, "of", lambda *_: replace(audience, latency=audience.latency + 0.3))
    assert known.of(now + 0.1, stream, WINDOW)[0].rate == pytest.approx(before, rel=0.02)
    for second in range(1, 40):
        known.of(now + second, stream, WINDOW)
    assert known.of(now + 40.0, stream, WINDOW)[0].rate == Cadences(view).of(now, stream, WINDOW)[0].rate < before


def test_where_samples_come_densely_or_unforeseen_it_does_not_matter_when(make_talk):
    """A stream of which one sample was seen, and one with many samples in each window."""
    view, stream, now = talking(make_talk, 1.0)
    assert Cadences(view).of(now, stream, 1.01 * DENSE) is None
    talk = make_talk(settle=0.0)
    talk.publish(0.1)
    (single,) = talk.core.view.own()
    assert Cadences(talk.core.view).of(0.2, single, WINDOW) is None
