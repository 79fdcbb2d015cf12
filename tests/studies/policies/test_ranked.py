"""Room by rank."""

from dataclasses import replace

from planner import Constraint, Linear, Message, Problem, Stream
from studies.policies.ranked import fits_by_rank, share

ROWS = tuple(Message(i, 0.1 * i, 0.1 * i, 0.1 * i, Linear(1.0, 0.2), 1.0, (float(i + 1),)) for i in range(3))
WINDOW = Problem(tuple(map(Stream, range(3))), ROWS, 0, (Constraint("c", 1.0, 4.0),), (), 0.0, 5.0)


def test_the_current_message_gets_what_those_before_it_leave():
    """A rival that does not fit any more takes nothing."""
    assert fits_by_rank(WINDOW, {0: 1.0, 1: 2.0})
    assert fits_by_rank(WINDOW, {0: 1.0, 1: 2.0, 2: 1.5})
    assert not fits_by_rank(replace(WINDOW, constraints=(Constraint("c", 1.0, 3.0),)), {0: 1.0, 2: 3.0})
    assert not fits_by_rank(WINDOW, {1: 2.0})


def test_a_share_is_the_greatest_part_of_a_limit():
    """What uses nothing has a little, so that worth can be divided by it."""
    assert share(WINDOW, 1) == 0.5
    assert 0.0 < share(replace(WINDOW, constraints=(Constraint("c", 1.0, 0.0),)), 1) < 1e-6
