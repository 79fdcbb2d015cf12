"""What takes long is done in the background."""

import threading

import pytest

from proxy.background import Background
from proxy.tuning import TUNING
from tests.waiting import wait_until


@pytest.fixture
def background():
    made = Background()
    yield made
    made.close(5.0)


def test_jobs_are_done_in_order_on_another_thread(background):
    """One after the other."""
    done = []
    for number in range(3):
        assert background.later(lambda number=number: done.append((number, threading.current_thread().name)))
    wait_until(lambda: len(done) == 3, what="three jobs")
    assert done == [(number, "costly features") for number in range(3)]


def test_only_so_many_wait(background):
    """The others are refused; when there is room again, they are not."""
    gate, begun, done = threading.Event(), threading.Event(), []
    background.later(lambda: begun.set() or gate.wait(5.0))
    assert begun.wait(5.0)
    room = TUNING.costly_jobs
    assert [background.later(lambda: done.append(1)) for _ in range(room + 1)] == [True] * room + [False]
    gate.set()
    wait_until(lambda: len(done) == room, what="what waited")
    assert background.later(lambda: done.append(2))
    wait_until(lambda: done[-1] == 2, what="one more")


def test_a_job_may_be_waited_for(background):
    """Until it is done, or for so long, also where it fails."""
    gate, done = threading.Event(), []
    assert background.within(60.0, lambda: done.append(1))
    assert done == [1]
    assert background.within(60.0, lambda: 1 / 0)
    assert background.within(0.0, lambda: gate.wait(60.0) and done.append(2))
    assert done == [1]
    gate.set()
    wait_until(lambda: done == [1, 2], what="what was waited for in vain")


def test_nobody_waits_where_too_many_do(background):
    """Nor is what he brings held for later."""
    gate, begun, done = threading.Event(), threading.Event(), []
    background.later(lambda: begun.set() or gate.wait(60.0))
    assert begun.wait(60.0)
    room = TUNING.costly_jobs
    assert [background.within(0.0, lambda: done.append(1)) for _ in range(room)] == [True] * room
    assert not background.within(60.0, lambda: done.append(2))
    gate.set()
    wait_until(lambda: len(done) == room, what="what waited")
    assert background.within(60.0, lambda: done.append(3))
    assert done == [1] * room + [3]


def test_nobody_waits_for_a_job_that_hangs(background, monkeypatch):
    """Until it is over; it may never be."""
    gate, begun, done = threading.Event(), threading.Event(), []
    background.later(lambda: begun.set() or gate.wait(60.0))
    assert begun.wait(60.0)
    later = background.now() + TUNING.hangs_after + 1.0
    monkeypatch.setattr(background, "now", lambda: later)
    assert not background.within(0.0, lambda: done.append(1))
    gate.set()
    wait_until(lambda: not background.warnings(later), what="its end")
    assert background.within(60.0, lambda: done.append(2))
    assert done == [2]


def test_a_job_that_fails_is_survived(background, caplog):
    """The log has why."""
    done = []
    background.later(lambda: 1 / 0)
    background.later(lambda: done.append(1))
    wait_until(lambda: done, what="the next job")
    assert "ZeroDivisionError" in caplog.text


def test_a_job_that_hangs_is_a_warning(background):
    """Until it is over."""
    gate, begun = threading.Event(), threading.Event()
    assert background.warnings(background.now() + 60.0) == []
    background.later(lambda: begun.set() or gate.wait(60.0))
    assert begun.wait(60.0)
    assert background.warnings(background.now()) == []
    (warning,) = background.warnings(background.now() + 60.0)
    assert warning.startswith("a feature takes longer than 2 s, and old values of others hold")
    gate.set()
    wait_until(lambda: not background.warnings(background.now() + 60.0), what="its end")


def test_a_stop_waits_for_the_job_in_hand_no_longer_than_it_may():
    """What waits is not begun any more."""
    background, gate, begun, done = Background(), threading.Event(), threading.Event(), []
    background.later(lambda: begun.set() or gate.wait(5.0))
    background.later(lambda: done.append(1))
    assert begun.wait(5.0)
    background.close(0.0)
    assert background._thread.is_alive()
    gate.set()
    background.close(5.0)
    assert not background._thread.is_alive()
    assert done == []


def test_its_clock_does_not_go_back(background):
    """It tells what jobs take."""
    assert background.now() <= background.now()
