"""What flights are worth."""

from dataclasses import replace

import pytest

from planner.definition import utility
from studies.simulation.conditions import WARM_UP, Conditions
from studies.simulation.missions import draw
from studies.simulation.records import Delivery, OnAir
from studies.simulation.scores import Yardsticks, measure, reached, same_decisions, scored, sent
from studies.simulation.usage import usage
from studies.workload import MIXED

HOW = Conditions(robots=3, limit=2, seconds=8.0, iterations=50)


class Sent:
    """What the scores look at of a team: some frames of a mission that arrive when the mission says."""

    def __init__(self, flown, indices, receivers=("op",)):
        frames = [(flown.frames[i], flown.problem.messages[i]) for i in indices]
        self.deliveries = [Delivery(f, m.t_sent, m.t_rcv, r) for f, m in frames for r in receivers]
        self.on_air = [OnAir(m.t_sent, f.robot, f.size, f) for f, m in frames]


@pytest.fixture(scope="module")
def flown():
    """A short mission."""
    return draw(MIXED, 0, HOW)


def test_what_arrives_as_the_mission_says_is_worth_what_the_planner_says(flown):
    """Counted from the end of the warm-up on."""
    every = range(len(flown.frames))
    whole = utility(flown.problem, every)
    assert 0.0 < utility(scored(flown.problem), every) < whole
    assert reached(flown, Sent(flown, every)) == pytest.approx(utility(scored(flown.problem), every))
    assert reached(flown, Sent(flown, ())) == 0.0


def test_in_broadcast_receivers_count_by_their_mean():
    """Who misses everything lowers it by its part."""
    how = replace(HOW, transport="broadcast")
    flown = draw(MIXED, 0, how)
    of_r0 = [i for i, frame in enumerate(flown.frames) if frame.robot == "r0"]
    both = reached(flown, Sent(flown, of_r0, ("r1", "r2")))
    assert both == pytest.approx(utility(scored(flown.problem), of_r0))
    assert reached(flown, Sent(flown, of_r0, ("r1",))) == pytest.approx(both / 2)


def test_the_bound_is_above_the_central_decider_and_loss_costs_it(flown):
    """The one who decides everything keeps the limit, too."""
    marks = measure(flown, 50)
    assert 0.8 * marks.bound < marks.central(flown, 0.0, 0) <= marks.bound * (1 + 1e-9)
    assert marks.central(flown, 0.5, 0) < 0.9 * marks.central(flown, 0.0, 0)
    assert Yardsticks(1.0, ()).central(flown, 0.1, 0) == 0.0


def test_decisions_are_compared_frame_by_frame(flown):
    """Those of the warm-up do not count."""
    due = [i for i, frame in enumerate(flown.frames) if frame.t_gen >= WARM_UP]
    early = min(due) - 1
    none = sent(flown, Sent(flown, ()))
    assert same_decisions(flown, none, sent(flown, Sent(flown, [early]))) == 1.0
    assert same_decisions(flown, none, sent(flown, Sent(flown, due[:2]))) == pytest.approx(1 - 2 / len(due))


def test_windows_count_what_exceeds(flown):
    """By whole messages; what robots tell each other counts only together."""
    due = [i for i, frame in enumerate(flown.frames) if frame.t_gen >= WARM_UP]
    used = usage(flown, Sent(flown, due[:2]), HOW)
    assert (used.exceeding, used.worst, used.together) == (0.0, 0, 0.0)
    assert used.messages == 2 / HOW.seconds
    used = usage(flown, Sent(flown, due[:4]), HOW)
    assert (used.exceeding, used.worst) == (0.5, 2)
    told = Sent(flown, due[:2])
    told.on_air.append(OnAir(told.on_air[-1].t, "r0", 10_000, digest=True))
    used = usage(flown, told, HOW)
    assert (used.exceeding, used.together) == (0.0, pytest.approx(2 / 3))
    assert used.told == pytest.approx(10_000 / HOW.seconds / 4)
    assert usage(flown, Sent(flown, ()), HOW).messages == 0.0
