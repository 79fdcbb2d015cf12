"""What a robot that decides alone knows, and the windows it builds of it."""

from dataclasses import replace

import pytest

from planner import Constraint, Linear, Message, Problem, Stream
from planner.validation import check_problem
from proxy.core.forecast.rhythm import Rhythm
from studies.alone.robot import Robot, Told
from studies.outlook import Outlook

MISSION = Problem((Stream(0), Stream(1), Stream(2)), (), 0, (Constraint("messages", 2.5, 2.0),), (), 0.0, 60.0)


def message(stream, t):
    """A message as an app has it; its mission says that it takes 9 s, which no robot knows."""
    return Message(stream, t, t, t + 9.0, Linear(1.0, 0.3), 5.0, (1.0,))


def told(stream, t, number, period=1.0, jitter=0.0):
    """What another robot's message carries."""
    own = message(stream, t)
    return Told(own, Outlook(number, own, Rhythm(period, t, number, jitter, 10), period))


def decided(robot, stream, t):
    """The window of a robot's next message, checked."""
    window = robot.window(robot.generate(message(stream, t)))
    check_problem(window)
    return window


def others(window, stream):
    """Open messages of a stream in a window, by time."""
    return [m.t_gen for m in window.messages if m.stream == stream and not m.sent]


def test_alone_a_robot_knows_its_own_messages_only():
    """Before anything was heard it expects more of its own stream and nothing of others, nor how long things take."""
    window = decided(Robot(MISSION, 10), 0, 3.0)
    assert {m.stream for m in window.messages} == {0}
    assert window.messages[window.current][:4] == (0, 3.0, 3.0, 3.0)
    assert len(window.messages) == 10
    assert window.goes_on


def test_what_was_heard_is_a_fact_and_its_stream_is_expected():
    """From when on it arrived; how long it took is what others of that robot, and its own, are expected to take."""
    robot = Robot(MISSION, 10)
    robot.hear(told(1, 2.0, number=4), 2.2)
    window = decided(robot, 0, 2.5)
    fact = next(m for m in window.messages if m.sent)
    assert (fact.stream, fact.t_gen, fact.t_rcv) == (1, 2.0, 2.2)
    assert window.messages[window.current].t_rcv == pytest.approx(2.7)
    assert others(window, 1)[:2] == pytest.approx([3.0, 4.0])
    coming = next(m for m in window.messages if m.stream == 1 and not m.sent)
    assert coming.t_rcv - coming.t_sent == pytest.approx(0.2)


def test_what_may_be_in_flight_is_open_and_what_should_be_here_was_dropped():
    """With a latency of 0.3 s a message due 0.2 s ago may come, one due 0.6 s ago was not sent."""
    robot = Robot(MISSION, 10)
    robot.hear(told(1, 1.0, number=1), 1.3)
    window = decided(robot, 0, 4.2)
    assert others(window, 1)[0] == pytest.approx(4.0)
    assert window.messages[window.current].t_gen == 4.2
    assert window.current == 2
    assert others(decided(robot, 0, 4.6), 1)[0] == pytest.approx(5.0)


def test_jittered_messages_of_others_are_expected_early_but_not_before_they_would_be_here():
    """One that is sent and not heard yet is not older than a latency."""
    robot = Robot(MISSION, 10)
    robot.hear(told(1, 1.0, number=1, jitter=0.1), 1.05)
    assert others(decided(robot, 0, 3.5), 1)[0] == pytest.approx(3.9)
    assert others(decided(robot, 0, 4.08), 1)[:2] == pytest.approx([4.03, 4.9])


def test_lost_messages_leave_no_trace_and_late_ones_no_confusion():
    """The number in a message tells what is due next; twice the same, or an older one later, changes no forecast."""
    robot = Robot(MISSION, 10)
    robot.hear(told(1, 5.0, number=5), 5.1)
    robot.hear(told(1, 5.0, number=5), 5.4)
    robot.hear(told(1, 4.0, number=4), 5.5)
    window = decided(robot, 0, 5.6)
    assert [m.t_gen for m in window.messages if m.sent] == [4.0, 5.0]
    assert [m.t_rcv for m in window.messages if m.sent] == [5.5, 5.1]
    assert others(window, 1)[0] == pytest.approx(6.0)


def test_old_facts_are_forgotten_but_for_the_last_of_each_stream():
    """Only what a constraint counts, and what is shown, stays in a window."""
    robot = Robot(MISSION, 10)
    for number, t in enumerate((1.0, 2.0, 3.0), start=1):
        robot.hear(told(1, t, number), t + 0.1)
    sent = robot.generate(message(0, 3.5))
    assert robot.send(sent).outlook.number == 1
    facts = [(m.stream, m.t_gen) for m in decided(robot, 0, 9.0).messages if m.sent]
    assert facts == [(1, 3.0), (0, 3.5)]


def test_windows_end_with_the_mission():
    """Where fewer messages are left than the horizon holds nothing comes after the window."""
    robot = Robot(replace(MISSION, t_end=12.0), 10)
    window = decided(robot, 0, 9.0)
    assert (window.t_end, window.goes_on) == (12.0, False)
