"""The channel of the benchmark refuses what exceeds a limit."""

import pytest

from planner.measures import Messages, Throughput
from studies.bench.channel import Channel
from studies.simulation.agenda import Agenda
from studies.simulation.medium import Medium
from studies.simulation.network import OverMedium


@pytest.fixture
def sends():
    """Send sizes at times over a channel with these limits; return the times that arrive."""

    def sent(limits, *messages, told=()):
        agenda, arrived = Agenda(), []
        channel = Channel(OverMedium(Medium(1e9, 0.0), agenda), limits)

        def arrive(_receiver, t):
            arrived.append(round(t, 3))

        for t, size in messages:
            if t in told:
                with channel.telling():
                    channel.send(t, size, "a", ["b"], arrive, broadcast=True)
            else:
                channel.send(t, size, "a", ["b"], arrive, broadcast=True)
        agenda.run(100.0)
        return arrived, channel.refused

    return sent


def test_what_exceeds_a_throughput_is_refused_and_not_counted(sends):
    """The window is closed: what lies just its length back still counts."""
    arrived, refused = sends([Throughput(100.0, 1.0)], (0.0, 60), (0.5, 60), (0.6, 40), (1.0, 60), (1.1, 60))
    assert arrived == [0.0, 0.6, 1.1]
    assert refused == [0.5, 1.0]


def test_messages_are_counted_whatever_their_size(sends):
    """But not what robots tell each other."""
    messages = [(0.0, 10), (0.1, 10_000), (0.2, 10), (0.3, 10)]
    arrived, refused = sends([Messages(2, 1.0)], *messages, told={0.2})
    assert arrived == [0.0, 0.1, 0.2]
    assert refused == [0.3]


def test_what_robots_tell_uses_bytes_and_is_no_sample(sends):
    """It may be refused, and counts for nobody then."""
    arrived, refused = sends([Throughput(100.0, 1.0)], (0.0, 60), (0.1, 30), (0.2, 30), (0.3, 10), told={0.1, 0.2})
    assert arrived == [0.0, 0.1, 0.3]
    assert refused == []


def test_a_message_larger_than_a_limit_may_go_when_nothing_else_was_sent(sends):
    """Within a window that is longer by as much."""
    arrived, refused = sends([Throughput(100.0, 1.0)], (0.0, 10), (1.5, 200), (2.1, 200), (2.2, 10), (5.0, 200))
    assert arrived == [0.0, 2.1, 5.0]
    assert refused == [1.5, 2.2]


def test_every_limit_holds(sends):
    """The tightest refuses."""
    limits = [Throughput(1000.0, 1.0), Messages(2, 2.0)]
    assert sends(limits, (0.0, 600), (0.5, 600), (0.6, 10), (0.7, 10)) == ([0.0, 0.6], [0.5, 0.7])


def test_what_is_sent_until_it_arrives_is_counted_and_never_refused():
    """As states of robots are."""
    agenda, arrived = Agenda(), []
    channel = Channel(OverMedium(Medium(1e9, 0.0), agenda), [Throughput(100.0, 1.0), Messages(5, 1.0)])
    channel.reliable(0.0, 500, "a", "b", arrived.append)
    channel.send(0.5, 10, "a", ["b"], lambda *_: arrived.append("sample"), broadcast=True)
    agenda.run(10.0)
    assert len(arrived) == 1
    assert channel.refused == [0.5]
    assert channel.delay("a", "b") == 0.0
