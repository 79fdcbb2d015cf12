"""Flights that are lived through again by other clocks."""

import pytest

from studies.simulation.clocks import Clock
from studies.simulation.conditions import Conditions
from studies.simulation.flights import crew
from studies.simulation.missions import draw
from studies.simulation.replay import Recorded, Relived, decided_alike
from studies.workload import MIXED

END = 20.0


@pytest.fixture(scope="module", params=["announce", "split"])
def flight(request):
    """Three robots under right clocks."""
    transport = "broadcast" if request.param == "announce" else "unicast"
    how = Conditions(robots=3, limit=10, seconds=15.0, iterations=30, coordination=request.param, transport=transport)
    flown = draw(MIXED, 0, how)
    flying = crew(Recorded, flown, how, 0)
    flying.run(flown.frames, END)
    return flying


@pytest.mark.full
def test_by_the_same_clocks_everything_falls_alike(flight):
    """Each robot weighs and sends the same samples, and finds the same."""
    alike = decided_alike(flight, {}, END)
    assert len(alike) == sum(len(life.weighed) for life in flight.lives.values()) > 0
    assert all(alike)


def test_a_wall_clock_that_steps_is_told_anew(flight):
    """By those who live through it again, as late as it may be."""
    again = Relived(flight, "r0", {"r1": Clock(steps=((2.0, 60.0),))})
    list(again.alike(END))
    assert again.cores["r0"].view.peers["z-r1"].inbound.wall_offset == pytest.approx(
        flight.cores["r0"].view.peers["z-r1"].inbound.wall_offset + 60.0
    )


def test_another_monotonic_clock_moves_all_times(flight):
    """Its own and what it hears; offsets between clocks are found as they are."""
    (robot, peer), *_ = [
        (robot, peer)
        for robot, core in flight.cores.items()
        for peer in core.view.peers.values()
        if peer.offset.known and peer.robot.startswith("r")
    ]
    again = Relived(flight, robot, {robot: Clock(7.0), peer.robot: Clock(-3.0)})
    list(again.alike(END))
    offset = again.cores[robot].view.peers[f"z-{peer.robot}"].offset.offset
    assert offset == pytest.approx(peer.offset.offset + 10.0, abs=1e-3)
