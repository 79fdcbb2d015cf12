"""Real traffic on a channel that nobody knows."""

import pytest

from proxy.core.model.limits import limits_of
from studies.simulation.traffic import unknown
from studies.simulation.traffic.unknown import RIGHT, Flight, under
from studies.simulation.traffic.workloads import mixed
from utility_specs.constraint_tables import FLOOR


def test_limits_are_told_in_what_the_radio_carries():
    """Adaptive ones by their ceiling, of which the floor is the usual part; the right one is fixed."""
    workload = mixed(2)
    (right,) = limits_of(under(workload, 0.0), 0.0, 1)
    assert (right.measure.limit, right.least) == (pytest.approx(RIGHT * workload.rate * workload.window), 1.0)
    (adaptive,) = limits_of(under(workload, 6.0), 0.0, 1)
    assert adaptive.measure.limit == pytest.approx(6.0 * workload.rate * workload.window)
    assert adaptive.least == FLOOR


@pytest.mark.full
@pytest.mark.parametrize("ceiling", [6.0, pytest.param(50.0, marks=pytest.mark.full)])
def test_what_is_small_and_urgent_comes_soon(ceiling):
    """Beside cameras for which there is no room, whatever an operator takes to be the most that the radio can carry."""
    reached = Flight("mixed", 2, 1.0, ceiling, 1, 25.0).fly()
    assert reached.kept >= 0.9
    assert reached.age[0] <= 0.2
    assert reached.alarms_sent == reached.alarms > 0
    assert reached.told <= 0.03 * mixed(2).rate


@pytest.mark.full
def test_a_team_on_a_poor_radio_goes_on_sending():
    """One frame takes most of a second there, and what all tell at first half a minute's allowance."""
    reached = Flight("mixed", 4, 0.3, 6.0, 1, 30.0).fly()
    assert reached.kept >= 0.2


@pytest.mark.full
def test_each_limit_has_a_row_beside_the_right_one(monkeypatch, tmp_path, capsys):
    """Which is what the others are measured by; rows are printed as they are flown, and the page tells how."""
    monkeypatch.setattr(unknown, "TEAMS", (("cameras", 1, 1.0),))
    page = tmp_path / "unknown.md"
    assert unknown.main(["--seeds", "1", "--seconds", "7", "--jobs", "1", "--output", str(page)]) == 0
    printed = capsys.readouterr().out.splitlines()
    assert [line.split("; ")[1] for line in printed] == [
        f"ceiling {limit}" for limit in ("right", "2 times", "6 times", "50 times")
    ]
    assert "utility of the right limit's 100.0%; small sent –" in printed[0]
    text = page.read_text()
    assert "python -m studies.simulation.traffic.unknown --seeds 1 --seconds 7" in text
    assert text.count("cameras, 1 robots") == 4
