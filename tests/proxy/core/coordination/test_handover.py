"""Room that a send leaves goes round: to its robot first, then to the next one."""

import pytest

from proxy.core.coordination.budget import Budget, Handover
from proxy.core.coordination.coordination import Coordination
from proxy.core.coordination.tuning import TUNING
from proxy.core.market.room import Room
from proxy.core.model.settings import CoreSettings
from proxy.core.view.stream import Sent
from proxy.core.view.view import SharedView
from tests.proxy.core.coordination.conftest import BYTES

NAMES = ("r1", "r2", "r3")


class Ours:
    """What one of three robots knows; the others have sent."""

    def __init__(self, robot, specs):
        self.view = SharedView(CoreSettings(robot, robot, settle=0.0), specs)
        self.others = [name for name in NAMES if name != robot]
        coordination = Coordination(0.0, self.view.settings, self.view)
        self.budget = Budget(self.view, coordination)
        for name in self.others:
            self.view.add_peer(0.0, name, name)
        coordination.set_members(0.0, self.view.peers)
        coordination.set_limits(0.0, (BYTES,))
        self.budget.set_limits((BYTES,))

    def sent(self, t, robot, size):
        if robot == self.view.settings.robot:
            self.budget.use(t, (float(size),))
        else:
            stream = self.view.streams.touch(t, robot, f"robot/{robot}/camera")
            self.view.traffic.note_sent(stream, stream.forwarded + 1, Sent(t, t, size, 1.0))


@pytest.fixture
def team(make_specs):
    return [Ours(name, make_specs()) for name in NAMES]


def opens(team, now, size=200.0):
    return [each.budget.opens(now, (size,), Room.IN_TURN) for each in team]


def test_room_that_a_robot_leaves_is_its_own_first_then_the_next_ones(team):
    """All others wait until they would have heard of who took it."""
    for each in team:
        for k, name in enumerate(NAMES):
            each.sent(1.0 + 0.1 * k, name, 330)
    first, second, third = opens(team, 1.3)
    assert first == pytest.approx(2.0, abs=1e-5)
    step = second - first
    assert step > 0.0
    assert third - first == pytest.approx(2 * step)


def test_the_turns_go_round(team):
    """Who comes before the robot that leaves it is the last."""
    for each in team:
        each.sent(1.0, "r2", 900)
        each.sent(1.1, "r1", 50)
        each.sent(1.1, "r3", 50)
    first, second, third = opens(team, 1.3)
    assert second == pytest.approx(2.0, abs=1e-5)
    assert second < third < first


def test_room_that_just_opened_is_not_everybodys_at_once(team):
    """A sample that comes at that moment takes it only in turn."""
    for each in team:
        each.sent(1.0, "r1", 900)
        each.sent(1.5, "r2", 300)
        each.sent(1.5, "r3", 100)
    now = 2.0 + 1e-3
    first, second, third = opens(team, now, 500.0)
    assert first < now < second < third
    assert not any(each.budget.lacking(now, (500.0,)) for each in team)


def test_where_there_is_room_nobody_waits(team):
    """Whoever sent before."""
    for each in team:
        for name in NAMES:
            each.sent(1.0, name, 200)
    assert max(opens(team, 1.1)) < 1.1


def test_no_turn_takes_longer_than_part_of_a_window(team):
    """However many robots take turns."""
    handover = Handover(team[0].view)
    assert handover.longest(2, (BYTES,)) < handover.longest(1000, (BYTES,)) == TUNING.handed_part * BYTES.window
