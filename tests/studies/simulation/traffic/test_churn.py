"""Robots that come and go in real traffic."""

import pytest

from studies.simulation.churn import joining
from studies.simulation.records import Delivery, OnAir
from studies.simulation.traffic.churn import ENDS, JOINS, MERGES, RETURNS, Turn, happenings, judge, line, linked, main
from studies.simulation.traffic.comparison import Cell
from studies.simulation.traffic.missions import WARM_UP

CELL = Cell("mixed", 4, 0.02, 0.0, 0, ENDS - WARM_UP)


class Flight:
    """What the judge looks at: sends at these times, by robot, of so many bytes."""

    def __init__(self, mission, sends, size=100):
        frame = mission.frames[0]
        self.deliveries: list[Delivery] = []
        self.on_air = [OnAir(t, robot, size, frame) for robot, times in sends.items() for t in times]


def test_the_last_robot_joins_late_and_half_of_the_team_is_cut_off():
    """What happens, and when who has a link to the operator."""
    robots = ["r0", "r1", "r2", "r3"]
    assert joining(happenings(robots)) == {"r3"}
    spans = linked(robots, 0.1)
    assert [len(spans[robot]) for robot in robots] == [1, 1, 2, 3]
    assert spans["r3"][0][0] == pytest.approx(JOINS + 0.108)


def test_first_samples_and_silences_are_measured_while_there_is_a_link():
    """A robot that is away is not silent."""
    mission = CELL.mission()
    steady = [t / 4 for t in range(int(4 * ENDS))]
    late = [t for t in steady if JOINS + 0.5 <= t < 16.0 or t >= RETURNS + 1.5]
    turn = judge(
        mission, Flight(mission, {"r0": steady, "r1": steady, "r2": [t for t in steady if t < 30], "r3": late}), 0.0
    )
    assert turn.first == pytest.approx((0.492, 1.492))
    assert [turn.silence[robot] for robot in ("r0", "r1")] == [0.25, 0.25]
    assert turn.silence["r2"] == pytest.approx(ENDS - MERGES - 0.008)
    assert turn.silence["r3"] == pytest.approx(1.492)
    assert (turn.over, turn.share) == (0.0, 0.0)
    nobody = judge(mission, Flight(mission, {}), 0.0)
    assert nobody.first == (float("inf"), float("inf"))


def test_windows_over_the_limit_are_timed_after_the_merge():
    """And counted before the team parts."""
    mission = CELL.mission()
    together = [MERGES + 0.1, MERGES + 0.2, MERGES + 0.3]
    turn = judge(mission, Flight(mission, {"r0": [8.0, 8.1, *together]}, size=26_000), 0.0)
    assert (turn.over, turn.share) == (pytest.approx(0.3), 0.0)
    turn = judge(mission, Flight(mission, {"r0": [8.0, 8.1, 8.2, 20.0]}, size=26_000), 0.0)
    assert (turn.over, turn.share) == (0.0, 0.25)
    assert "else 25.0 %" in line(CELL, "x/unicast", turn)
    assert "first sample 5 ms, 7 ms" in line(CELL, "x/unicast", Turn((0.005, 0.007), {"r0": 1.0}, 0.0, 0.0))


@pytest.mark.full
def test_teams_that_change_go_on(capsys):
    """Robots that broadcast send soon after they have links, and again after the merge."""
    assert main(["--teams", "announce/broadcast", "--workload", "random", "--robots", "3"]) == 0
    assert "random:3 20 ms 1 % seed 0 announce/broadcast | first sample" in capsys.readouterr().out
