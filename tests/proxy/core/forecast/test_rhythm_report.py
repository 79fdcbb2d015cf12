"""Rhythms as digests report them."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.forecast.rhythm import Rhythm
from proxy.core.forecast.rhythm_report import decoded, encoded
from proxy.core.forecast.tuning import TUNING
from proxy.core.protocol.messages import PHASES, StreamDigest


def news(t, *rhythm):
    return StreamDigest(7, 20, 3, t, t, 100, 1.0, (), *rhythm)


@given(st.floats(0.01, 100.0), st.floats(-0.5, 0.5), st.floats(0.0, 0.3), st.floats(0.0, 1e4))
def test_who_is_reported_a_rhythm_expects_what_its_robot_does(period, late, looseness, t):
    """To a part of the period, on its own clock."""
    rhythm = Rhythm(period, t - late * period, 20, looseness * period, 16)
    back = decoded(news(t, *encoded(rhythm, 20, t)), lambda theirs: theirs + 5.0)
    assert back.due(25) == pytest.approx(rhythm.due(25) + 5.0, abs=1.1 * period / PHASES)
    assert back.jitter == pytest.approx(rhythm.jitter, abs=0.6 * period / PHASES)


def test_without_a_rhythm_nothing_is_reported():
    """Nor of one that is faster than times can tell."""
    assert encoded(None, 20, 1.0) == encoded(Rhythm(1e-5, 1.0, 20, 0.0, 16), 20, 1.0) == (0.0, 0, 0)
    assert decoded(news(1.0), float) is None
    assert decoded(news(1.0, 1e-9, 5, 5), float) is None


def test_who_is_reported_a_rhythm_knows_from_how_many_samples_at_most_it_was_found():
    """So it is the less sure of it the younger the stream was."""
    reported = [decoded(replace(news(1.0, 0.1, 0, 5), generated=generated), float) for generated in (1, 20, 900)]
    assert [rhythm.known for rhythm in reported] == [TUNING.fewest, 20, TUNING.memory]
