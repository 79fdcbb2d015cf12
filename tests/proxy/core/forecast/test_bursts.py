"""Bursts in generation times."""

import pytest

from proxy.core.forecast.patterns import Span, bursts_in, reported_bursts
from tests.proxy.core.streams import bursts, periodic, poisson


def numbered(times):
    return list(enumerate(times, 1))


def test_bursts_are_found_by_their_pauses():
    """Size, step and spacing are those of the stream."""
    found = bursts_in(numbered(bursts(8, size=4, step=0.1, spacing=3.0)), whole=True)
    assert (found.size, found.step, found.begun) == (4, pytest.approx(0.1), 4)
    assert (found.pause, found.period, found.jitter) == (pytest.approx(3.0), pytest.approx(0.75), pytest.approx(0.0))
    assert found.kind == "bursts 4 0.1"


def test_a_burst_goes_on():
    """With a sample that comes soon; one that comes late begins another."""
    found = bursts_in(numbered([*bursts(4), 8.0]), whole=True)
    assert found.joined(8.05).expect(Span(8.05, 8.05, 9.0, 9)) == pytest.approx([8.1, 8.15, 8.2])
    assert found.joined(8.3) is None


def test_two_bursts_and_a_begun_one_are_enough():
    """If they are alike."""
    assert bursts_in(numbered([*bursts(2), 4.0]), whole=True).begun == 1
    assert bursts_in(numbered([0.0, 0.1, 2.0, 2.1, 2.2, 2.3, 2.4, 2.5, 4.0, 4.1]), whole=True) is None


def test_the_first_burst_may_have_begun_before_what_is_remembered():
    """Then it tells nothing of the size."""
    assert bursts_in(numbered(bursts(6, size=6)[4:]), whole=False).size == 6


@pytest.mark.parametrize("times", [periodic(48, jitter=0.1), poisson(48, seed=1), [1.0, 2.0], [*periodic(20), 99.0]])
def test_not_every_pause_ends_a_burst(times):
    """Jitter, chance, and a single pause make none."""
    assert bursts_in(numbered(times), whole=True) is None


def test_of_reported_bursts_the_last_sample_ends_one():
    """Size and step come as words; nonsense is none."""
    told = reported_bursts(["bursts", "3", "0.1"], 1.0, 10.0)
    assert told.expect(Span(10.0, 10.0, 13.05, 9)) == pytest.approx([12.8, 12.9, 13.0])
    for nonsense in ("bursts", "bursts 3", "bursts 1 0.1", "bursts 3 nan", "bursts 3 2", "bursts x 1", "bursts 1e9 1"):
        assert reported_bursts(nonsense.split(), 1.0, 10.0) is None
