"""Silence is told apart from robots that may seldom speak."""

import pytest

from proxy.core.congestion.liveness import Liveness


def spoken(every, until):
    """Robots that say something each so often, and are heard."""
    liveness = Liveness(0.0)
    for i in range(1, int(until / every) + 1):
        liveness.digest_sent(i * every)
        liveness.digest_received(i * every + 0.01)
        liveness.echo_received(i * every + 0.02)
    return liveness


def test_silence_is_when_nobody_is_heard():
    """For some seconds."""
    liveness = spoken(0.5, 20.0)
    for i in range(1, 8):
        liveness.digest_sent(20.0 + 0.5 * i)
    assert not liveness.silent(22.0)
    assert liveness.silent(23.5)


def test_silence_is_when_nobody_hears_us():
    """Although we hear the others."""
    liveness = spoken(0.5, 20.0)
    for i in range(1, 12):
        liveness.digest_sent(20.0 + 0.5 * i)
        liveness.digest_received(20.0 + 0.5 * i)
    assert liveness.silent(25.5)
    liveness.echo_received(25.5)
    assert not liveness.silent(25.5)


def test_what_is_overdue_is_noticed_before_silence():
    """Where all speak often; who seldom speaks does not expect much."""
    liveness = spoken(0.2, 20.0)
    assert not liveness.overdue(20.3, 0.1, 1)
    liveness.digest_sent(20.3)
    liveness.digest_sent(20.6)
    assert not liveness.overdue(20.7, 0.1, 1)
    assert liveness.overdue(20.7, 0.1, 2)
    assert liveness.overdue(21.0, 0.1, 1)
    assert not liveness.overdue(20.7, 0.4, 2)
    assert not liveness.silent(20.7)
    assert not spoken(4.0, 40.0).overdue(43.0, 0.1, 9)


def test_what_waited_on_its_way_is_no_fresh_news():
    """However much of it comes; nor is what overtook it forgotten."""
    liveness = spoken(0.2, 20.0)
    for tenth in range(1, 10):
        liveness.digest_sent(20.0 + tenth / 10.0)
        liveness.digest_received(20.0 + tenth / 10.0, tenth / 10.0)
    assert liveness.staleness(20.9) == pytest.approx(0.89)
    assert liveness.overdue(20.9, 0.1, 2)


def test_how_rarely_we_are_told_that_we_are_heard_is_learnt():
    """Where there are many each is told in its turn, but nobody waits for ever."""
    liveness = Liveness(0.0)
    for second in range(1, 41):
        liveness.digest_sent(float(second))
        liveness.digest_received(float(second))
        if second % 4 == 0:
            liveness.echo_received(float(second))
    for second in range(41, 48):
        liveness.digest_sent(float(second))
        liveness.digest_received(float(second))
    assert not liveness.silent(47.0)
    for second in range(48, 60):
        liveness.digest_sent(float(second))
        liveness.digest_received(float(second))
    assert liveness.silent(59.0)


def test_who_may_seldom_speak_expects_to_hear_seldom():
    """The allowance is the same for all."""
    liveness = spoken(4.0, 40.0)
    assert liveness.interval(42.0) == 4.0
    assert not liveness.silent(50.0)
    assert liveness.last_sent == 40.0


def test_nobody_who_came_late_was_silent():
    """Nobody was there to be heard."""
    liveness = Liveness(0.0)
    liveness.digest_sent(99.0)
    liveness.digest_sent(100.0)
    liveness.restart(100.0)
    assert not liveness.silent(101.0)
