"""Equal parts of a large team: turns by the clock, which all know."""

import math
from itertools import pairwise

import pytest

from proxy.core.coordination.equal_parts import NOT_NEEDED, ClockTurns
from proxy.core.coordination.team import Team
from proxy.core.coordination.tuning import TUNING
from proxy.core.model.limits import limits_of
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import StreamState
from proxy.core.view.stream import Generated
from proxy.core.view.view import SharedView
from tests.proxy.core.coordination.conftest import WINDOW, names

STEP = 0.01
"""How closely turns are looked at [s]."""


@pytest.fixture
def make_turns(make_specs):
    """The turns of the robot at a `place` among so many, whose messages take this part of the limit.

    Of the others so many `tellers` have such that take another one, which they have `told`.
    """

    def make(robots, place, part, *, told=0.0, tellers=0, ahead=0.0):
        own = f"p{place - 1:02d}x" if place else "a"
        specs = make_specs(window=WINDOW)
        view, limits = SharedView(CoreSettings("r1", own), specs), limits_of(specs, 0.02, robots)
        size = round(part * limits[0].limit)
        stream = view.streams.touch(0.0, "r1", "robot/r1/camera")
        for count in range(9):
            stream.note_generated(count + 1, Generated(count - 8.5, size, 1.0))
        others = names(robots - 1)
        for number, name in enumerate(others):
            view.add_peer(0.0, name, name)
            theirs, key = round((told if number < tellers else part) * limits[0].limit), f"robot/{name}/camera"
            view.peers[name].told[key] = StreamState(1, key, "camera", 0.5, size=theirs)
        view.clocks.offset = ahead
        team, turns = Team(view, 0.0), ClockTurns(0.0, [WINDOW])
        team.set_members(view.peers)
        turns.look(view, limits, team)
        return turns

    return make


def sends(turns, part, *, seconds=60.0, small=0.0):
    """When a robot sends that has a message at any time, and sends small ones that use this part of each second."""
    found = []
    for number in range(round(seconds / STEP)):
        now = number * STEP
        turn = turns.turn(now, 0, part)
        if small:
            turns.sent(now, [small * STEP])
        if turn.began <= now and (not found or turn.began > found[-1] + STEP):
            assert turn.began <= now < turn.began + TUNING.turn_time * WINDOW + STEP
            found.append(now)
            turns.sent(now, [part])
    return found


@pytest.mark.full
@pytest.mark.parametrize(
    ("robots", "part"), [(26, 0.07), (30, 0.11), (50, 0.04), (40, 0.3), (6, 0.34), (4, 0.6), (6, 0.25), (12, 0.49)]
)
def test_no_window_has_more_turns_than_there_is_room_for(make_turns, robots, part):
    """However many robots there are, and however large a message is; at most two fifths of the room are left."""
    each = [sends(make_turns(robots, place, part), part, seconds=90.0) for place in range(robots)]
    assert all(each)
    start = max(times[0] for times in each)
    turns = sorted(t for times in each for t in times if t >= start)
    most = max(sum(t <= other < t + WINDOW for other in turns) for t in turns)
    fitting = math.floor(1.0 / (part * (TUNING.turn_size if robots > TUNING.large_team else 1.0)))
    assert 0.6 * fitting <= most <= fitting


def test_who_misses_some_of_the_others_has_nearly_the_same_turns(make_turns):
    """Else the turns of robots that do not hear all would lie anywhere."""
    all_heard, some = sends(make_turns(49, 20, 0.04), 0.04), sends(make_turns(46, 19, 0.04), 0.04)
    assert all_heard == pytest.approx(some, abs=0.1 * WINDOW)


def test_all_have_the_turns_of_the_largest_messages_that_states_tell_of(make_turns):
    """Ours are smaller, and go as seldom. Of one alone they tell nothing: it could take the turns of all others."""
    small, beside = (sends(make_turns(30, 7, 0.07, told=told, tellers=2), 0.07) for told in (0.07, 0.14))
    large, lone = sends(make_turns(30, 7, 0.14), 0.14), sends(make_turns(30, 7, 0.07, told=0.9, tellers=1), 0.07)
    apart = [times[1] - times[0] for times in (small, beside, large, lone)]
    assert apart[1] == pytest.approx(apart[2], abs=2 * STEP)
    assert apart[0] == pytest.approx(apart[3], abs=2 * STEP)
    assert apart[0] < 0.7 * apart[1]


@pytest.mark.parametrize(("part", "posers", "slots"), [(0.08, "a", 3), (0.15, "a", 3), (0.15, "ac", 2)])
def test_all_count_as_many_copies_as_each_stream_goes_in(make_specs, part, posers, slots):
    """Whoever has a small one that three want: else its turns were so long that three frames went in one of them."""
    specs = make_specs(window=WINDOW)
    limits, found = limits_of(specs, 0.02, 4), []
    frame, pose = (round(each * limits[0].limit) for each in (0.3, part))
    streams = {name: {f"robot/{name}/camera": frame} for name in "abcd"}
    for name in posers:
        streams[name][f"robot/pose-{name}/camera"] = pose
    for own in "abd":
        view = SharedView(CoreSettings(own, own), specs)
        for name in set("abcd") - {own}:
            view.add_peer(0.0, name, name)
            told = {key: StreamState(1, key, "camera", 0.5, size=size) for key, size in streams[name].items()}
            view.peers[name].told |= told
        for key, size in streams[own].items():
            stream = view.streams.touch(0.0, own, key)
            for count in range(9):
                stream.note_generated(count + 1, Generated(count - 8.5, size, 1.0))
        for name in "abcd":
            poses = [f"robot/pose-{other}/camera" for other in posers if other != name]
            view.subscribers.set(name, (*poses, *(["robot/*/camera"] if name == "d" else [])))
        team, turns = Team(view, 0.0), ClockTurns(0.0, [WINDOW])
        team.set_members(view.peers)
        turns.look(view, limits, team)
        found.append(turns.turn(100.0, 0, 0.3).slot)
    assert found == pytest.approx([1.0 / slots] * 3)


def test_who_alone_has_large_messages_sends_them_as_its_part_allows(make_turns):
    """Small ones beside them do not use up what it saves."""
    times = sends(make_turns(10, 3, 0.3, told=0.001, tellers=9), 0.3, seconds=200.0, small=0.2 * 0.1 / WINDOW)
    apart = [later - earlier for earlier, later in pairwise(times)]
    assert 0.3 * 10 * WINDOW < min(apart) < max(apart) < 1.5 * 0.3 * 10 * WINDOW


def test_turns_are_by_the_wall_clock(make_turns):
    """A robot whose own clock began later has the same ones, and knows when the next one begins."""
    here, there = make_turns(10, 3, 0.3), make_turns(10, 3, 0.3, ahead=1_000.0)
    for now in (1_030.0, 1_031.5, 1_033.25):
        mine, theirs = here.turn(now, 0, 0.3), there.turn(now - 1_000.0, 0, 0.3)
        assert theirs.next + 1_000.0 == pytest.approx(mine.next)
        assert here.turn(mine.next + STEP, 0, 0.3).began == pytest.approx(mine.next)


def test_who_uses_its_part_for_small_samples_has_few_turns(make_turns):
    """What they leave of it is saved for a large message; nobody saves more than for one."""
    part, ours, all_paid = 0.3, 0.1 / WINDOW, 0.3 * 10 * WINDOW
    beside = sends(make_turns(10, 3, part), part, seconds=200.0, small=0.8 * ours / TUNING.small_counts)
    apart = [later - earlier for earlier, later in pairwise(beside)]
    assert 4.0 * all_paid < min(apart) < max(apart) < 8.0 * all_paid, "a fifth is left for it"
    assert sends(make_turns(10, 3, part), part, small=1.1 * ours) == []


def test_messages_no_larger_than_a_part_need_no_turn(make_turns):
    """Nor does any while nobody has sent anything of which the size is known."""
    assert make_turns(10, 3, 0.3).turn(1.0, 0, 0.1) == NOT_NEEDED
    assert make_turns(10, 3, 0.3).turn(1.0, 0, 0.11) != NOT_NEEDED
    assert ClockTurns(0.0, [WINDOW]).turn(1.0, 0, 0.3) == NOT_NEEDED


@pytest.mark.parametrize(("part", "needed"), [(0.31, True), (0.15, False)])
def test_turns_are_needed_for_messages_much_larger_than_an_equal_part(make_turns, part, needed):
    """Of seven robots each has a seventh, and such messages of several at once are more than the limit."""
    assert make_turns(7, 2, part).needed is needed
    assert make_turns(7, 2, 0.02, told=part, tellers=6).needed is needed
