"""Wall clocks that disagree."""

import pytest

from proxy.core.interface import events as ev
from proxy.core.interface.commands import Notice, SendState
from proxy.core.protocol.messages import Digest, Echo, State


def meet(talk, wall_offset):
    """Robot r2's monotonic clock shows 500 s less than ours; a digest and an echo take 10 ms."""
    talk.tell(ev.PeerAppeared(0.0, "r2", "z-r2"))
    hear(talk, 1.0)
    return state(talk, 1.1, wall_offset)


def hear(talk, at):
    echoes = (Echo("z-r1", at - 0.02, at - 500.01, 0, 0.0),)
    return talk.tell(ev.DigestHeard(at, Digest("r2", "z-r2", at - 500.01, 0, 0, (), echoes)))


def state(talk, at, wall_offset):
    return talk.tell(ev.StateHeard(at, State("r2", "z-r2", "enforce", "", wall_offset=wall_offset)))


def clock_notices(commands):
    return [(c.level, c.text) for c in commands if isinstance(c, Notice) and "clock" in c.text]


@pytest.mark.parametrize(
    ("error", "text"),
    [
        (10.0, "the clock of r2 is 10.000 s ahead of that of r1: timestamps cannot be compared"),
        (-0.1, "the clock of r2 is 0.100 s behind that of r1: timestamps cannot be compared"),
    ],
)
def test_a_robot_whose_wall_clock_shows_another_time_is_named_once(make_talk, error, text):
    """With how much and which way, in the log once and in the status as long as it lasts."""
    talk = make_talk(wall_offset=1000.0)
    assert clock_notices(meet(talk, 1500.0 + error)) == [("warning", text)]
    assert clock_notices(hear(talk, 2.0)) == []
    status = talk.core.status(2.0)
    assert status["warnings"] == [text]
    assert status["peers"][0]["wall_ahead"] == pytest.approx(error, abs=1e-3)
    assert clock_notices(state(talk, 3.0, 1500.0)) == [("info", "the clocks of r2 and r1 agree again")]
    assert talk.core.status(3.0)["warnings"] == []


def test_what_the_offset_may_be_wrong_by_is_no_difference_of_clocks(make_talk):
    """Nor is anything said before a peer told of its clock, or before there was an echo."""
    talk = make_talk(wall_offset=1000.0)
    assert clock_notices(meet(talk, 1500.055)) == []
    assert talk.core.status(1.0)["peers"][0]["clock_uncertainty"] == pytest.approx(0.01, abs=1e-3)
    silent = make_talk()
    silent.tell(ev.PeerAppeared(0.0, "r2", "z-r2"))
    assert clock_notices(hear(silent, 1.0)) == []
    assert silent.core.status(1.0)["peers"][0]["wall_ahead"] is None
    deaf = make_talk()
    deaf.tell(ev.PeerAppeared(0.0, "r2", "z-r2"))
    assert clock_notices(state(deaf, 1.0, 70.0)) == []
    assert deaf.core.status(1.0)["peers"][0]["clock_uncertainty"] is None


def test_a_difference_that_hovers_at_the_limit_is_no_news_each_time(make_talk):
    """It must shrink by more than it had to grow."""
    talk = make_talk(wall_offset=1000.0)
    meet(talk, 1500.065)
    assert [clock_notices(state(talk, 2.0 + at, 1500.0 + ahead)) for at, ahead in enumerate((0.055, 0.065, 0.055))] == [
        [],
        [],
        [],
    ]
    assert clock_notices(state(talk, 6.0, 1500.02)) == [("info", "the clocks of r2 and r1 agree again")]


def test_a_step_of_our_own_wall_clock_is_told(make_talk):
    """In a state, at once if it is a millisecond; and what others' clocks show is read anew."""
    talk = make_talk(wall_offset=1000.0)
    meet(talk, 1500.0)
    talk.tell(ev.TimePassed(2.0))
    assert not any(isinstance(c, SendState) for c in talk.tell(ev.ClockChanged(3.0, 1000.0005)))
    said = talk.tell(ev.ClockChanged(4.0, 940.0))
    assert [c.state.wall_offset for c in said if isinstance(c, SendState)] == [940.0]
    text = "the clock of r2 is 60.000 s ahead of that of r1: timestamps cannot be compared"
    assert clock_notices(said) == [("warning", text)]


def tells(talk, at, number, error, wall_offset=1500.0):
    """Robot r2 tells in a state how wrong its wall clock is, then sends a digest; return how well we know its clock."""
    told = State("r2", "z-r2", "enforce", "", wall_offset=wall_offset, number=number, clock_error=error)
    talk.tell(ev.StateHeard(at, told))
    talk.tell(ev.DigestHeard(at + 0.5, Digest("r2", "z-r2", at - 499.51, 0, 0, state=number)))
    return round(talk.core.status(at + 0.5)["peers"][0]["clock_uncertainty"], 3)


def test_wall_clocks_that_are_known_to_be_right_bound_the_offset(make_talk):
    """If both are, and nothing else is in force; what is known fades slowly when they are known no more."""
    talk = make_talk(wall_offset=1000.0)
    meet(talk, 1500.0)
    assert tells(talk, 2.0, 1, 0.001) == 0.01
    talk.tell(ev.ClockChanged(3.0, 1000.0, 0.001))
    assert tells(talk, 4.0, 2, 0.001) == 0.005
    assert talk.core.status(5.0)["peers"][0]["wall_error"] == 0.001
    assert tells(talk, 6.0, 3, 0.0) == 0.005
    assert talk.core.status(7.0)["peers"][0]["wall_error"] is None
    assert tells(talk, 16.0, 4, 0.0) == 0.007


def test_what_a_wall_clock_showed_before_it_was_set_is_forgotten(make_talk):
    """Ours or theirs: it was not right."""
    talk = make_talk(wall_offset=1000.0)
    meet(talk, 1500.0)
    talk.tell(ev.ClockChanged(2.0, 1000.0, 0.001))
    assert tells(talk, 3.0, 1, 0.001) == 0.005
    assert tells(talk, 5.0, 2, 0.0, wall_offset=1500.1) == 0.01
    assert tells(talk, 7.0, 3, 0.001) == 0.005
    talk.tell(ev.ClockChanged(9.0, 1000.1, 0.0))
    assert tells(talk, 10.0, 4, 0.001) > 0.01


def test_how_wrong_our_wall_clock_may_be_is_told(make_talk):
    """At once, as a step is."""
    talk = make_talk(wall_offset=1000.0)
    meet(talk, 1500.0)
    talk.tell(ev.TimePassed(2.0))
    said = talk.tell(ev.ClockChanged(3.0, 1000.0, 0.02))
    assert [(c.state.clock_error, c.update) for c in said if isinstance(c, SendState)] == [(0.02, None)]


def test_of_two_states_of_one_number_none_is_trusted(make_talk):
    """One of them is forged: what it says of the clock must not let us send what others may."""
    talk = make_talk(wall_offset=1000.0)
    meet(talk, 1500.0)
    talk.tell(ev.ClockChanged(2.0, 1000.0, 0.001))
    assert tells(talk, 3.0, 1, 0.001) == 0.005
    assert tells(talk, 5.0, 1, 0.001, wall_offset=1500.005) >= 0.01
    assert tells(talk, 7.0, 2, 0.001) == 0.005
