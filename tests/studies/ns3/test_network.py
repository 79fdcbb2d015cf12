"""Teams that speak over ns-3."""

from dataclasses import replace
from functools import partial

import pytest

from proxy.core.model.settings import CoreSettings, broadcast
from studies.ns3.network import JITTER, Ns3Network
from studies.ns3.radio import AD_HOC, Radio
from studies.simulation.agenda import Agenda
from studies.simulation.conditions import WARM_UP, Conditions
from studies.simulation.flights import GROUP
from studies.simulation.medium import Medium
from studies.simulation.missions import draw
from studies.simulation.scores import reached
from studies.simulation.team import Team
from studies.workload import FEW_IMPORTANT

pytestmark = pytest.mark.full
TEAM = ("a", "b", "c")


@pytest.fixture
def agenda():
    """Of the team."""
    return Agenda()


def test_a_broadcast_reaches_those_who_are_meant(agenda):
    """Who is out of reach of the team hears it, too, but is none of its receivers."""
    heard = []
    with Radio(3) as radio:
        network = Ns3Network(radio, agenda, TEAM)
        agenda.at(
            1.0, lambda t: network.send(t, 200, "a", ("c",), lambda who, at: heard.append((who, at)), broadcast=True)
        )
        agenda.run(2.0)
    ((who, at),) = heard
    assert who == "c"
    assert 1.0 < at < 1.002 + JITTER


def test_answers_and_actions_happen_in_the_order_of_their_times(agenda):
    """Both simulators keep pace: an arrival comes between two actions, and its answer before a later one."""
    told = []
    with Radio(3) as radio:
        network = Ns3Network(radio, agenda, TEAM)

        def answer(who, at):
            told.append(("heard", who))
            network.send(at, 50, who, ("a",), lambda whom, _: told.append(("answered", whom)), broadcast=False)

        agenda.at(0.5, lambda t: network.send(t, 50, "a", ("b",), answer, broadcast=False))
        agenda.at(0.4, lambda _: told.append("before"))
        agenda.at(0.6, lambda _: told.append("after"))
        agenda.run(1.0)
    assert told == ["before", ("heard", "b"), ("answered", "a"), "after"]


def test_what_a_robot_sends_leaves_it_in_order(agenda):
    """Though each message waits for a moment of its own."""
    heard = []
    with Radio(3) as radio:
        network = Ns3Network(radio, agenda, TEAM, seed=4)
        for number in range(20):
            arrive = partial(lambda number, *_: heard.append(number), number)
            agenda.at(0.0, lambda t, arrive=arrive: network.send(t, 30, "a", ("b",), arrive, broadcast=True))
        agenda.run(1.0)
    assert heard == list(range(20))


def test_what_is_sent_reliably_arrives_once_and_in_order_whatever_is_lost(agenda):
    """It is sent again until it does, and what came before it waits."""
    heard = []
    with Radio(3, replace(AD_HOC, loss=0.7), seed=2) as radio:
        network = Ns3Network(radio, agenda, TEAM)
        for number in range(10):
            arrive = partial(lambda number, *_: heard.append(number), number)
            agenda.at(0.1 * number, lambda t, arrive=arrive: network.reliable(t, 300, "a", "b", arrive))
        agenda.run(20.0)
    assert heard == list(range(10))


def test_a_team_of_cores_does_as_well_over_ns3_as_over_a_medium_of_the_same_latency():
    """What robots tell each other gets through, so they share the limit as well."""
    how = Conditions(transport="broadcast", latency=0.004, seconds=15.0, robots=5)
    flown = draw(FEW_IMPORTANT, 1, how)
    settings = CoreSettings("", "", transport=broadcast(GROUP), digests_on_air=True)

    def worth(**carrier):
        team = Team(flown.specs, flown.interests, Medium(1e7, how.latency), settings=settings, **carrier)
        team.run(flown.frames, WARM_UP + how.seconds)
        return reached(flown, team)

    agenda = Agenda()
    with Radio(len(flown.interests)) as radio:
        over_ns3 = worth(network=Ns3Network(radio, agenda, tuple(flown.interests)), agenda=agenda)
    assert over_ns3 > 0.95 * worth()
