"""Silence is told apart from robots that may seldom speak."""

import pytest

from proxy.core.congestion.liveness import Hearing


def spoken(every, until):
    """Robots that say something each so often, and are heard."""
    hearing = Hearing(0.0)
    for i in range(1, int(until / every) + 1):
        hearing.said(i * every)
        hearing.heard(i * every + 0.01)
        hearing.heard_by(i * every + 0.02)
    return hearing


def test_silence_is_when_nobody_is_heard():
    """For some seconds."""
    hearing = spoken(0.5, 20.0)
    for i in range(1, 8):
        hearing.said(20.0 + 0.5 * i)
    assert not hearing.silent(22.0)
    assert hearing.silent(23.5)


def test_silence_is_when_nobody_hears_us():
    """Although we hear the others."""
    hearing = spoken(0.5, 20.0)
    for i in range(1, 12):
        hearing.said(20.0 + 0.5 * i)
        hearing.heard(20.0 + 0.5 * i)
    assert hearing.silent(25.5)
    hearing.heard_by(25.5)
    assert not hearing.silent(25.5)


def test_what_is_overdue_is_noticed_before_silence():
    """Where all speak often; who seldom speaks does not expect much."""
    hearing = spoken(0.2, 20.0)
    assert not hearing.overdue(20.3, 0.1, 1)
    hearing.said(20.3)
    hearing.said(20.6)
    assert not hearing.overdue(20.7, 0.1, 1)
    assert hearing.overdue(20.7, 0.1, 2)
    assert hearing.overdue(21.0, 0.1, 1)
    assert not hearing.overdue(20.7, 0.4, 2)
    assert not hearing.silent(20.7)
    assert not spoken(4.0, 40.0).overdue(43.0, 0.1, 9)


def test_what_waited_on_its_way_is_no_fresh_news():
    """However much of it comes; nor is what overtook it forgotten."""
    hearing = spoken(0.2, 20.0)
    for tenth in range(1, 10):
        hearing.said(20.0 + tenth / 10.0)
        hearing.heard(20.0 + tenth / 10.0, tenth / 10.0)
    assert hearing.stale(20.9) == pytest.approx(0.89)
    assert hearing.overdue(20.9, 0.1, 2)


def test_how_rarely_we_are_told_that_we_are_heard_is_learnt():
    """Where there are many each is told in its turn, but nobody waits for ever."""
    hearing = Hearing(0.0)
    for second in range(1, 41):
        hearing.said(float(second))
        hearing.heard(float(second))
        if second % 4 == 0:
            hearing.heard_by(float(second))
    for second in range(41, 48):
        hearing.said(float(second))
        hearing.heard(float(second))
    assert not hearing.silent(47.0)
    for second in range(48, 60):
        hearing.said(float(second))
        hearing.heard(float(second))
    assert hearing.silent(59.0)


def test_who_may_seldom_speak_expects_to_hear_seldom():
    """The allowance is the same for all."""
    hearing = spoken(4.0, 40.0)
    assert hearing.gap(42.0) == 4.0
    assert not hearing.silent(50.0)
    assert hearing.last_said == 40.0


def test_nobody_who_came_late_was_silent():
    """Nobody was there to be heard."""
    hearing = Hearing(0.0)
    hearing.said(99.0)
    hearing.said(100.0)
    hearing.restart(100.0)
    assert not hearing.silent(101.0)
