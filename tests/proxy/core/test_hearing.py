"""Silence is told apart from robots that may seldom speak."""

from proxy.core.hearing import Hearing


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
