"""Where all would plan for all and news take long, one robot plans and lends."""

from statistics import fmean

import pytest

from planner import Throughput
from proxy.core.lateness import LATE, PACE, STAYS, Lateness
from proxy.core.limits import Limit
from proxy.core.settings import CoreSettings
from proxy.core.shares import Shares
from proxy.core.view import SharedView
from proxy.core.wire import Digest
from studies.simulation.conditions import Conditions
from studies.simulation.flights import fly, team
from studies.simulation.missions import draw, scenario
from studies.simulation.usage import usage
from utility_specs import Specs

WINDOW = 2.0
CHANNEL = Limit("channel", WINDOW, 4000.0, Throughput(4000.0, WINDOW))


@pytest.fixture
def view():
    made = SharedView(CoreSettings("r0", "r0-zid", transport="broadcast g", coordination="overhear"), Specs((), (), ""))
    made.add_peer(0.0, "r1", "r1-zid")
    return made


@pytest.fixture
def shares():
    """Of a robot that leads: it has heard the other one."""
    made = Shares("a", (CHANNEL,), floor=0.01, settled_at=0.0)
    made.set_members(-1.0, "ab")
    made.heard(0.0, "b", 0)
    assert made.leads
    return made


def measure(view, latency):
    offset = next(iter(view.peers.values())).offset
    offset.heard(1.0, 1.0 + latency)
    offset.echoed(1.0, 1.0 + latency)


def test_news_are_late_by_the_shortest_window(view, shares):
    """A tenth of it; without any limit nothing is late."""
    measure(view, 1.01 * LATE * WINDOW)
    lateness = Lateness(view, shares)
    lateness.look(0.0, ())
    assert not lateness.late
    lateness.look(0.5 * PACE, (CHANNEL,))
    assert not lateness.late
    lateness.look(PACE, (CHANNEL,))
    assert lateness.late


def test_news_that_become_a_little_quicker_are_still_late(view, shares):
    """So that a team does not waver."""
    measure(view, 1.01 * LATE * WINDOW)
    lateness = Lateness(view, shares)
    lateness.look(0.0, (CHANNEL,))
    for part, late in ((1.01 * STAYS, True), (0.99 * STAYS, False), (1.01 * STAYS, False)):
        now = lateness._due
        view.peers.clear()
        view.add_peer(now, "r1", "r1-zid")
        measure(view, part * LATE * WINDOW)
        lateness.look(now, (CHANNEL,))
        assert lateness.late is late


def test_whether_news_are_late_says_who_leads(view, shares):
    """Whatever a robot finds itself: where they did not agree, one would wait for what the other does not lend."""
    following = Shares("b", (CHANNEL,), floor=0.01, settled_at=0.0)
    following.set_members(-1.0, "ab")
    following.heard(0.0, "a", shares.epoch)
    assert following.leader == "a"
    view.add_peer(0.0, "a", "a")
    lateness = Lateness(view, following)
    measure(view, 1.01 * LATE * WINDOW)
    for now, lends in enumerate((None, False, True, False)):
        if lends is not None:
            assert view.heard_digest(now, Digest("a", "a", now, shares.epoch, 0, 0, lends=lends))
        lateness.look(now, (CHANNEL,))
        assert lateness.late is bool(lends)


def test_clocks_are_trusted_only_where_the_union_need_not_hold_for_certain(view):
    """That ways there and back take alike nobody knows."""
    measure(view, 1.0)
    peer = next(iter(view.peers.values()))
    assert view.doubt(1.0, peer) < 0.02
    shares = SharedView(CoreSettings("r0", "r0-zid"), Specs((), (), ""))
    shares.add_peer(0.0, "r1", "r1-zid")
    measure(shares, 1.0)
    assert shares.doubt(1.0, next(iter(shares.peers.values()))) >= 1.0


@pytest.mark.parametrize(("name", "least"), [("mixed", 1.5), ("few", 1.4)])
def test_at_a_latency_of_a_second_the_union_keeps_the_limit(name, least):
    """Ten robots, five messages in 2.5 s, 1 % lost; of two a second that would be allowed most are sent.

    Messages whose times are known are lent one by one, others have slots.
    """
    how = Conditions(coordination="overhear", transport="broadcast", limit=5, latency=1.0, loss=0.01, seconds=15.0)
    flown = draw(scenario(name), 0, how)
    flight = fly(flown, how, 0)
    used = usage(flown, flight, how)
    assert used.exceeding == 0.0
    assert used.messages >= least
    leader = next(core for core in flight.cores.values() if core.shares.leads)
    assert leader.gate.late
    assert leader.gate.standing is (name == "few")
    if name == "few":  # how irregular streams are is found while nothing is lent for single messages, too
        assert fmean(leader.layout._spread(stream) for stream in leader.view.streams()) > 0.05


def test_all_know_it_as_soon_as_somebody_leads():
    """Who did not would send what it was not lent, or wait for what nobody lends."""
    how = Conditions(coordination="overhear", transport="broadcast", latency=1.0)
    flown = draw(scenario("mixed"), 0, how)
    flight = team(flown, how, 0)
    flight.run(flown.frames, 6.0)
    assert all(core.gate.late for core in flight.cores.values())
