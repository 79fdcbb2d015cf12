"""Small jobs, in order, on a thread of their own."""

import threading
from dataclasses import replace

import pytest
import zenoh

from proxy.bridge import serial_executor as executor_module
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.serial_executor import SerialExecutor
from tests.waiting import wait_until


@pytest.fixture
def executor(stack):
    made = SerialExecutor("test")
    stack.callback(made.close, 1.0)
    return made


def test_jobs_run_in_order(executor):
    """What was offered first is done first."""
    done, last = [], threading.Event()
    for i in range(100):
        assert executor.offer(lambda i=i: done.append(i))
    executor.insist(last.set)
    assert last.wait(60.0)
    assert done == list(range(100))


def test_an_executor_without_jobs_has_no_thread(stack):
    """It comes with the first job, and is the only one."""
    before = threading.active_count()
    executor, done = SerialExecutor("test"), threading.Event()
    stack.callback(executor.close, 1.0)
    assert threading.active_count() == before
    executor.offer(lambda: None)
    executor.offer(done.set)
    assert done.wait(60.0)
    assert threading.active_count() == before + 1


def test_a_closed_executor_takes_no_thread(executor):
    """What is offered afterwards is not done."""
    executor.close(1.0)
    before = threading.active_count()
    executor.offer(lambda: None)
    assert threading.active_count() == before


def test_a_job_that_zenoh_refuses_does_not_stop_the_executor(executor, caplog):
    """The refusal is logged, the next job is done."""

    def refused():
        raise zenoh.ZError("session closed")

    done = threading.Event()
    executor.offer(refused)
    executor.offer(done.set)
    assert done.wait(60.0)
    assert "session closed" in caplog.text


def test_a_job_that_fails_does_not_stop_the_executor(executor, caplog):
    """The log has why, the next job is done."""
    done = threading.Event()
    executor.offer(lambda: 1 / 0)
    executor.offer(done.set)
    assert done.wait(60.0)
    assert "test: a job failed" in caplog.text


def held(stack):
    """Return an executor that lets one job wait, and has one in hand until the event is set."""
    executor, go, started = SerialExecutor("test", 1), threading.Event(), threading.Event()
    stack.callback(executor.close, 1.0)
    executor.offer(lambda: (started.set(), go.wait(60.0)))
    assert started.wait(60.0)
    return executor, go


def test_a_full_lane_refuses_offers_but_not_what_must_be_done(stack):
    """Offers beyond the bound are counted and refused."""
    executor, go = held(stack)
    done = threading.Event()
    assert executor.offer(lambda: None)
    assert not executor.offer(lambda: None)
    executor.insist(done.set)
    go.set()
    assert done.wait(60.0)
    assert executor.refused == 1


def test_who_may_wait_waits_until_fewer_jobs_do(stack):
    """And comes in then."""
    executor, go = held(stack)
    done = threading.Event()
    executor.await_room(60.0)
    executor.offer(lambda: None)
    waiting = threading.Thread(target=lambda: (executor.await_room(60.0), executor.offer(done.set)))
    waiting.start()
    go.set()
    assert done.wait(60.0)
    waiting.join(60.0)
    assert executor.refused == 0


def test_few_wait_at_a_time(stack, monkeypatch):
    """Others are let go on at once: the threads that wait are Zenoh's."""
    monkeypatch.setattr(executor_module, "BOUNDS", replace(BOUNDS, waiting_for_jobs=1))
    executor, go = held(stack)
    executor.offer(lambda: None)
    waiting = threading.Thread(target=executor.await_room, args=(60.0,))
    waiting.start()
    wait_until(lambda: executor._waiting == 1, what="one that waits")
    executor.await_room(1e6)
    go.set()
    waiting.join(60.0)
    assert executor._waiting == 0


def test_nobody_waits_twice_for_a_thread_that_is_stuck(stack):
    """Whoever brings something is held up once, until something is done again."""
    executor, go = held(stack)
    done = threading.Event()
    executor.offer(done.set)
    executor.await_room(0.01)
    executor.await_room(1e6)
    assert not executor.offer(lambda: None)
    go.set()
    assert done.wait(60.0)
    executor.await_room(60.0)
    assert executor.offer(lambda: None)
