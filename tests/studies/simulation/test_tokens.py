"""Presence tokens of which nothing else is known."""

from functools import partial

import pytest

from proxy.core.interface.events import PeerAppeared, PeerGone
from studies.simulation.traffic.comparison import Cell, how_of
from studies.simulation.traffic.flights import crew

CELL = Cell("mixed", 2, 0.02, 0.0, 0, 3.0)
BEGINS = 6.0


def flown(names):
    """Let so many names come each second, and go after one; return how many small samples went, and bytes, then."""
    mission = CELL.mission()
    team = crew(mission, how_of(CELL, "announce/unicast"), 0)

    def tell(kind, robot, zid, t):
        for member in team.members.values():
            team._feed(member, t, kind(member.now(t), robot, zid))

    for second in range(2):
        for name in range(names):
            who = f"g{second}-{name}", f"{10 * second + 100:04d}{name:04d}"
            team.agenda.at(BEGINS + second, partial(tell, PeerAppeared, *who))
            team.agenda.at(BEGINS + second + 0.9, partial(tell, PeerGone, *who))
    team.run(mission.frames, BEGINS + 2.0)
    sent = [air for air in team.on_air if air.frame is not None and air.t >= BEGINS]
    return sum(air.frame.size < 1000 for air in sent), sum(air.size for air in sent)


@pytest.mark.full
@pytest.mark.parametrize("names", [pytest.param(1, marks=pytest.mark.full), 50])
def test_names_that_come_and_go_without_a_word_cost_a_team_nothing(names):
    """Each would have a part of the limit, and a copy of each sample: fifty left four robots 1 % of small samples."""
    small, large = flown(0)
    assert flown(names)[0] == small
    assert flown(names)[1] >= 0.9 * large
