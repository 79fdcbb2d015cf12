"""What a team does until it has agreed on parts for the first time."""

from dataclasses import replace

import numpy as np
import pytest

from proxy.core.coordination.tuning import TUNING
from studies.simulation.traffic.comparison import Cell, how_of
from studies.simulation.traffic.flights import crew

SECONDS = 8.0


def flown(workload, robots, contender, seed=0, later=0.0):
    """Let a team start all at once; return when it sent [s], and how much each of its windows held at most.

    Applications begin so much `later` [s], from which times count.
    """
    cell = Cell(workload, robots, 0.02, 0.01, seed, SECONDS - 5.0)
    how = how_of(cell, contender)
    mission = cell.mission(everybody=how.broadcasts)
    team = crew(mission, how, seed)
    team.run([replace(frame, t_gen=frame.t_gen + later) for frame in mission.frames], SECONDS + later)
    sent = sorted((air.t - later, air.size) for air in team.on_air if air.frame is not None)
    times, sizes = np.array([t for t, _ in sent]), np.array([size for _, size in sent])
    ends = np.searchsorted(times, times - mission.window, side="right")
    total = np.concatenate([[0], np.cumsum(sizes)])
    return times, (total[1:] - total[ends]) / mission.carried, team


@pytest.mark.parametrize("contender", ["announce/unicast", "announce/broadcast"])
@pytest.mark.parametrize("robots", [8, pytest.param(10, marks=pytest.mark.full)])
def test_a_team_of_equal_messages_sends_its_first_one_as_it_comes(contender, robots):
    """None fits an equal part, and to agree on others takes seconds; until then all plan for all, first in turns.

    Within the limit: that two send what only one of them may is seldom.
    """
    over = 0
    for seed in range(3):
        times, held, _ = flown("uniform-mixed", robots, contender, seed)
        assert times[0] < 0.5 + TUNING.first_time
        assert sum(times < 2.5) >= 4
        assert held.max() <= 1.15
        over += held.max() > 1.0
    assert over <= 1


def test_a_team_that_was_switched_on_long_before_sends_as_soon():
    """What it needs to agree on parts is still there, and who has agreed need not announce anything."""
    times, held, _ = flown("uniform-mixed", 10, "announce/unicast", later=20.0)
    assert sum(times < 2.5) >= 4
    assert sum(times < 7.5) >= 10
    assert held.max() <= 1.0


@pytest.mark.full
def test_all_keep_to_their_parts_once_these_have_been_agreed_on_for_a_window():
    """Nobody has to announce what it sends any more."""
    _, _, team = flown("uniform-mixed", 8, "announce/unicast")
    for core in team.cores.values():
        assert core.parts.coordination.formation.established
        assert core.parts.coordination.binds


@pytest.mark.full
def test_who_asks_for_parts_by_configuration_never_plans_for_all():
    """The union holds at any latency and loss, so nobody sends what has no part yet."""
    times, _, _ = flown("uniform-mixed", 10, "split/unicast")
    assert times[0] > 1.0
