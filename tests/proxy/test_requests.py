"""Signals, whichever thread the kernel gives them to."""

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from proxy.requests import SIGNALS, Requests, asked_to_end
from tests.waiting import wait_until


@pytest.fixture(autouse=True)
def handlers():
    """Others want their signals back."""
    before = {number: signal.getsignal(number) for number in SIGNALS}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_ends_the_wait_at_once_whichever_thread_it_comes_to(number):
    """Long before the time is over; the main thread would not wake by itself."""
    end, beside = threading.Event(), threading.Event()

    def other():
        beside.set()
        end.wait()

    thread = threading.Thread(target=other)
    thread.start()
    beside.wait()
    with Requests() as asked:
        sender = threading.Timer(0.05, signal.pthread_kill, (thread.ident, number))
        sender.start()
        assert asked.next(3600.0) == number.name
        sender.join()
    end.set()
    thread.join()


def test_signals_are_told_one_by_one():
    """None that comes meanwhile is lost."""
    with Requests() as asked:
        for number in (signal.SIGHUP, signal.SIGTERM):
            signal.raise_signal(number)
        assert [asked.next(0.0) for _ in range(3)] == ["SIGHUP", "SIGTERM", ""]


def test_afterwards_python_tells_nobody():
    """Its socket is gone, and its number may be another file's."""
    with Requests():
        pass
    assert signal.set_wakeup_fd(-1) == -1


def test_what_signals_did_before_they_do_afterwards():
    """A command ends, and whoever called it goes on."""
    before = [signal.getsignal(number) for number in SIGNALS]
    with asked_to_end() as asked:
        signal.raise_signal(signal.SIGINT)
        assert asked.next(3600.0) == "SIGINT"
    assert [signal.getsignal(number) for number in SIGNALS] == before


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_request_to_end_that_nobody_takes_up_ends_the_process(number):
    """As where a file is read that never ends: systemd would have to kill it, and a terminal could not."""
    reads = "from proxy.requests import Requests; asked = Requests(1); print('reads', flush=True); open(0).read()"
    with subprocess.Popen([sys.executable, "-c", reads], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdout.readline() == b"reads\n"
        stat = Path(f"/proc/{process.pid}/stat")
        # One that comes just before the process reads wakes nothing: Python runs no handler until the next one comes.
        wait_until(lambda: stat.read_text().rpartition(") ")[2].startswith("S"), what="the read")
        process.send_signal(number)
        assert process.wait(60.0) == -signal.SIGALRM


def test_a_request_to_end_that_is_taken_up_ends_nothing_by_itself():
    """Nor does one to read files anew."""
    with Requests(3600) as asked:
        for number in (signal.SIGTERM, signal.SIGHUP):
            os.kill(os.getpid(), number)
            assert asked.next(3600.0) == number.name
            assert signal.alarm(0) == 0
        os.kill(os.getpid(), signal.SIGTERM)
    assert signal.alarm(0) == 0
