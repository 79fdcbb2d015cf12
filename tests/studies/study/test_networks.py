"""Networks of the study."""

import pytest

from studies.simulation.agenda import Agenda
from studies.study.networks import PACKET, network
from studies.study.tasks import Task

TASK = Task("best", "mixed", 5.0, 0, network="own")
TEAM = ("r0", "r1", "r2")


def heard(task, size=2_048, until=5.0):
    """When r1 and r2 hear a message that r0 sends at 1 s."""
    agenda, found = Agenda(), []
    with network(task, TEAM) as carry:
        carrier = carry(agenda)
        agenda.at(
            1.0,
            lambda t: carrier.send(t, size, "r0", TEAM[1:], lambda who, at: found.append((who, at)), broadcast=True),
        )
        agenda.run(until)
    return found


@pytest.mark.parametrize("name", ["own", pytest.param("adhoc", marks=pytest.mark.full)])
def test_latency_is_added(name):
    """To whatever the network itself takes."""
    plain, later = heard(TASK.but(network=name)), heard(TASK.but(network=name, latency=0.3))
    assert [who for who, _ in later] == [who for who, _ in plain]
    for (_, soon), (_, late) in zip(plain, later, strict=True):
        assert late - soon == pytest.approx(0.3)
        assert 1.003 < soon < 1.008


@pytest.mark.parametrize("name", ["own", pytest.param("adhoc", marks=pytest.mark.full)])
def test_reliable_messages_are_later_by_as_much(name):
    """And the delay that members are told of is."""
    found = []
    for latency in (0.0, 0.3):
        agenda = Agenda()
        with network(TASK.but(network=name, latency=latency), TEAM) as carry:
            carrier = carry(agenda)
            carrier.reliable(1.0, 100, "r0", "r1", found.append)
            found.append(carrier.delay("r0", "r1"))
            agenda.run(2.0)
    usual, plain, more, later = found
    assert later - plain == pytest.approx(0.3)
    assert more - usual == pytest.approx(0.3)


@pytest.mark.parametrize("name", ["own", pytest.param("adhoc", marks=pytest.mark.full)])
def test_others_on_the_channel_take_of_it(name):
    """Nobody of the team hears them; with more than the channel bears messages wait."""
    waited = [max(at for _, at in heard(TASK.but(network=name, background=rate, seed=2))) for rate in (0.0, 450e3)]
    assert waited[1] > waited[0] + 0.001
    assert PACKET < 1_500
