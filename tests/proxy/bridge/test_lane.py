"""Small jobs, in order, on a thread of their own."""

import threading

import pytest
import zenoh

from proxy.bridge.lane import Lane


@pytest.fixture
def lane(stack):
    made = Lane("test")
    stack.callback(made.close, 1.0)
    return made


def test_jobs_run_in_order(lane):
    """What was offered first is done first."""
    done, last = [], threading.Event()
    for i in range(100):
        assert lane.offer(lambda i=i: done.append(i))
    lane.insist(last.set)
    assert last.wait(60.0)
    assert done == list(range(100))


def test_a_job_that_zenoh_refuses_does_not_stop_the_lane(lane, caplog):
    """The refusal is logged, the next job is done."""

    def refused():
        raise zenoh.ZError("session closed")

    done = threading.Event()
    lane.offer(refused)
    lane.offer(done.set)
    assert done.wait(60.0)
    assert "session closed" in caplog.text


def test_a_job_that_fails_does_not_stop_the_lane(lane, caplog):
    """The log has why, the next job is done."""
    done = threading.Event()
    lane.offer(lambda: 1 / 0)
    lane.offer(done.set)
    assert done.wait(60.0)
    assert "test: a job failed" in caplog.text


def test_a_full_lane_refuses_offers_but_not_what_must_be_done(stack):
    """Offers beyond the bound are counted and refused."""
    lane = Lane("test", 1)
    stack.callback(lane.close, 1.0)
    go, started, done = threading.Event(), threading.Event(), threading.Event()
    lane.offer(lambda: (started.set(), go.wait(60.0)))
    assert started.wait(60.0)
    assert lane.offer(lambda: None)
    assert not lane.offer(lambda: None)
    lane.insist(done.set)
    go.set()
    assert done.wait(60.0)
    assert lane.refused == 1
