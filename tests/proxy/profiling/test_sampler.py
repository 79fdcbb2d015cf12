"""Where the time of this process goes, as its threads find out themselves."""

import threading
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

import pytest
import zenoh

from proxy.profiling.layout import LayoutError, find_layout
from proxy.profiling.sampler import TURN, Sampler
from tests.ports import free_port


def sampled(seconds=0.5, rate=1000.0):
    """What a sampler finds on a thread of its own, and that sampler."""

    def sample():
        sampler = Sampler(find_layout(), seconds, rate)
        return sampler, sampler.run()

    with ThreadPoolExecutor(1) as pool:
        return pool.submit(sample).result()


@contextmanager
def beside(work):
    """Do some work again and again on another thread."""
    done = threading.Event()

    def run():
        while not done.is_set():
            work()

    thread = threading.Thread(target=run, name="beside")
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()


def compute():
    return inner(20_000)


def inner(count):
    return sum(number * number for number in range(count))


def by_function(spent):
    """What was spent in each function and what it called [s]."""
    sums = Counter()
    for each in spent:
        for function in {function.name for function in each.stack}:
            sums[function] += each.seconds
    return sums


def test_a_busy_function_is_found_with_those_that_called_it():
    """What runs has nearly all that its thread took."""
    with beside(compute):
        sampler, spent = sampled()
    found = by_function(spent)
    whole = sum(each.seconds for each in spent if each.thread == "beside")
    assert sampler.looks > 0
    assert found["compute"] > 0.8 * whole > 0.0
    assert found["inner"] > 0.8 * whole
    (stack,) = {each.stack for each in spent if each.stack and each.stack[0].name == "inner.<locals>.<genexpr>"}
    assert [function.name for function in stack][:4] == [
        *("inner.<locals>.<genexpr>", "inner", "compute", "beside.<locals>.run"),
    ]
    assert stack[0].file == __file__


def test_turns_that_are_short_are_found_too():
    """However short they are: what a thread does between two waits is seen, not that it waits."""

    def turn():
        inner(300)
        time.sleep(0.0002)

    with beside(turn):
        _, spent = sampled(2.0)
    found = by_function(spent)
    assert found["inner"] > 0.2 * sum(each.seconds for each in spent if each.thread == "beside")


def test_a_thread_that_waits_counts_nothing():
    """It is there, and took nothing."""
    stop = threading.Event()
    idle = threading.Thread(target=stop.wait, name="idle")
    idle.start()
    with beside(compute):
        _, spent = sampled()
    stop.set()
    idle.join()
    assert sum(each.seconds for each in spent if each.thread == "idle") == 0.0


def test_of_deep_stacks_the_innermost_functions_are_told():
    """They count like all others."""

    def deep(levels):
        return deep(levels - 1) if levels else inner(20_000)

    with beside(lambda: deep(100)):
        _, spent = sampled()
    whole = sum(each.seconds for each in spent if each.thread == "beside")
    assert by_function(spent)["inner"] > 0.5 * whole > 0.0


def test_a_thread_that_was_never_seen_counts_where_it_waits():
    """It took next to nothing: no look came while it ran."""
    with beside(lambda: time.sleep(0.01)):
        _, spent = sampled(0.3, rate=1.0)
    (found,) = [each for each in spent if each.thread == "beside"]
    assert found.seconds > 0.0
    assert "beside.<locals>.run" in [function.name for function in found.stack]


def test_what_the_kernel_counts_is_shared_out():
    """Nothing is lost or counted twice."""
    with beside(compute):
        sampler, spent = sampled()
    assert sum(each.seconds for each in spent) == pytest.approx(sampler.whole, rel=0.1, abs=0.02)
    assert sampler.own < 0.2 * sampler.seconds


def test_a_thread_that_comes_later_counts_from_its_beginning():
    """All that it took."""
    with beside(lambda: time.sleep(0.001)), ThreadPoolExecutor(1) as pool:
        taken = pool.submit(sampled, 4 * TURN)
        with beside(compute):
            sampler, spent = taken.result()
    names = {each.thread for each in spent}
    assert "beside" in names
    assert by_function(spent)["compute"] > 0.5 * sampler.whole


def test_threads_of_zenoh_are_seen_in_callbacks_and_outside():
    """What of their time is Python's is told by its functions."""
    config = zenoh.Config()
    for key, value in {
        "mode": '"peer"',
        "listen/endpoints": f'["tcp/127.0.0.1:{free_port()}"]',
        "scouting/multicast/enabled": "false",
    }.items():
        config.insert_json5(key, value)
    other = zenoh.Config()
    for key, value in {
        "mode": '"client"',
        "connect/endpoints": config.get_json("listen/endpoints"),
        "scouting/multicast/enabled": "false",
    }.items():
        other.insert_json5(key, value)

    def receive(_sample):
        inner(2_000)

    with zenoh.open(config) as session, zenoh.open(other) as app:
        subscriber = session.declare_subscriber("a", zenoh.handlers.Callback(receive, indirect=False))
        with beside(lambda: (app.put("a", b"x"), time.sleep(0.0005))):
            _, spent = sampled(1.0)
        subscriber.undeclare()
    zenohs = [each for each in spent if each.thread.startswith("rx-")]
    assert by_function(zenohs)[receive.__qualname__] > 0.3 * sum(each.seconds for each in zenohs) > 0.0


def test_it_ends_when_it_is_stopped():
    """Long before its time."""
    sampler = Sampler(_layout(), 60.0, 100.0)
    thread = threading.Thread(target=sampler.run)
    thread.start()
    sampler.stop()
    thread.join()
    assert sampler.seconds < 30.0


def test_after_the_end_nothing_looks_any_more():
    """There is no thread more than before, and no timer."""
    before = set(threading.enumerate())
    sampler, _ = sampled(0.1)
    looks = sampler._eyes.looks
    compute()
    assert sampler._eyes.gather() == []
    assert sampler._eyes.looks == looks
    assert set(threading.enumerate()) <= before, "a thread of others may end meanwhile"


def test_where_memory_cannot_be_read_that_is_said(monkeypatch):
    """Some containers forbid it."""
    monkeypatch.setattr("proxy.profiling.layout.words", lambda _address, _count: [])
    with pytest.raises(LayoutError, match="does not let this process read its own memory"):
        _layout()


def test_a_python_that_is_laid_out_unlike_any_other_is_refused(monkeypatch):
    """It is not guessed what its memory means."""
    monkeypatch.setattr("proxy.profiling.layout.words", lambda _address, count: [0] * count)
    with pytest.raises(LayoutError, match=r"keeps .* where it is not found"):
        _layout()


def _layout():
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(find_layout).result()
