"""What is expected of a stream from what was seen of it."""

import pytest

from planner import Constraint, Linear, Message
from studies.outlook import PRIOR, Watch, interval_between_sends, supposed


def watched(stream, times, use=1.0):
    """A stream whose messages were generated at these times."""
    watch = Watch()
    for number, t in enumerate(times):
        watch.observe(Message(stream, t, t, t + 0.25, Linear(1.0, 0.1 * (number + 1)), 2.0, (use,)))
    return watch


def test_means_of_what_was_seen_are_expected():
    """Utility and size are means so far, the times those of the rhythm."""
    outlook = watched(3, [0.5, 2.5, 4.5]).outlook()
    assert outlook.typical.utility.slope == pytest.approx(0.2)
    assert outlook.means(4.6, 2) == pytest.approx([6.5, 8.5])
    message = outlook.message(6.5)
    assert (message.stream, message.t_sent, message.t_rcv, message.scale, message.use) == (3, 6.5, 6.75, 2.0, (1.0,))


def test_a_stream_of_one_message_has_the_mean_period_of_the_others():
    """Or the core's guess while there is none; nothing is expected of one that nobody heard."""
    outlooks = {
        1: watched(1, [0.0, 2.0]).outlook(),
        2: watched(2, [0.0, 4.0]).outlook(),
        3: watched(3, [1.0]).outlook(),
    }
    assert supposed(outlooks)[3].means(1.0, 2) == pytest.approx([4.0, 7.0])
    assert supposed(outlooks)[1] == outlooks[1]
    assert supposed({3: outlooks[3]})[3].means(1.0, 1) == pytest.approx([1.0 + PRIOR])
    with pytest.raises(ValueError, match="before its first message"):
        Watch().outlook()


def test_streams_without_rhythm_are_expected_at_their_mean_interval_from_now_on():
    """How long none has come says nothing about the next."""
    times = [0.0, 0.1, 1.3, 1.35, 3.9, 4.0, 4.1, 6.9, 7.0, 8.8, 8.9, 9.0, 12.2, 12.3, 13.9, 14.0]
    outlook = watched(0, times).outlook()
    assert outlook.rhythm is None
    assert outlook.jitter == 0.0
    assert outlook.means(20.0, 2) == pytest.approx([20.0 + outlook.period, 20.0 + 2 * outlook.period])


def test_the_interval_between_sends_fills_the_tightest_limit():
    """Two streams of unequal rate and size; without a limit that binds they send what they generate."""
    outlooks = {1: watched(1, [0.0, 1.0, 2.0]).outlook(), 2: watched(2, [0.0, 2.0, 4.0], use=4.0).outlook()}
    mean_use = (1.0 * 1.0 + 0.5 * 4.0) / 1.5
    assert interval_between_sends(outlooks, (Constraint("c", 2.0, 1.0),)) == pytest.approx(2 * mean_use * 2.0)
    assert interval_between_sends(outlooks, (Constraint("c", 1.0, 99.0),)) == pytest.approx(2 / 1.5)
    assert interval_between_sends(outlooks, (Constraint("c", 1.0, 0.0),)) == pytest.approx(2 / 1.5)
