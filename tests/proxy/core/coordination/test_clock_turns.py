"""Turns by the clock: in a large team each robot has one, and all know their own without a word."""

import math

import pytest

from proxy.core.coordination.clock_turns import ClockTurns
from proxy.core.coordination.tuning import TUNING

WINDOW = 2.5
STEP = 0.01
"""How closely turns are looked at [s]."""


def begins(robots, place, part, *, turns=None, since=0.0, seconds=60.0):
    """When the turns of a robot begin that has messages of this part of the limit all the time."""
    turns, found = turns or ClockTurns(WINDOW), set()
    for number in range(round(seconds / STEP)):
        now = since + number * STEP
        began = turns.began(now, place / robots, robots, part)
        if began < math.inf:
            assert began <= now < began + WINDOW
            found.add(round(began, 6))
    return sorted(found)


@pytest.mark.parametrize(("robots", "parts"), [(26, 1.6), (30, 3.3), (50, 2.0), (40, 12.0)])
def test_no_window_has_more_turns_than_there_is_room_for(robots, parts):
    """However many robots there are, and however large a message is; at most a third of the room is left."""
    each = [begins(robots, place, parts / robots) for place in range(robots)]
    assert all(each)
    start = max(times[0] for times in each)
    turns = sorted(t for times in each for t in times if t >= start)
    most = max(sum(t <= other < t + WINDOW for other in turns) for t in turns)
    assert robots / parts / 1.35 - 1.0 <= most <= robots / parts + 1.0


def test_who_misses_some_of_the_others_has_nearly_the_same_turns():
    """Else the turns of robots that do not hear all would lie anywhere."""
    all_heard, some = begins(49, 20, 0.04), begins(46, 19, 0.04)
    assert all_heard == pytest.approx(some, abs=0.1 * WINDOW)


def test_messages_whose_sizes_vary_have_the_turns_of_the_largest():
    """Until none was that large for some turns."""
    turns, small = ClockTurns(WINDOW), begins(30, 7, 0.07)
    large = begins(30, 7, 0.14, turns=turns)
    assert begins(30, 7, 0.07, turns=turns)[:2] == large[:2] != small[:2]
    later = begins(30, 7, 0.07, turns=turns, since=60.0 + TUNING.turn_cycles * (large[1] - large[0]))
    assert later[1] - later[0] == pytest.approx(small[1] - small[0])
