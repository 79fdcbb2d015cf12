"""Waits end as soon as they can, and last longer on a machine that is busy."""

import os
import subprocess
import sys

import pytest

from tests.waiting import MOST, slowness, wait_until


def test_what_never_comes_true_fails_with_its_name():
    """However slow the machine is."""
    with pytest.raises(AssertionError, match="the moon did not come true within"):
        wait_until(lambda: False, timeout=0.01, what="the moon")


def test_what_did_not_come_true_may_tell_how_things_are():
    """As of when it failed."""
    phases = []
    with pytest.raises(AssertionError, match="phase 3 did not come true within"):
        wait_until(
            lambda: phases.append("seen") or len(phases) > 3, timeout=-1.0, what=lambda: f"phase {len(phases) + 2}"
        )


def test_the_condition_is_asked_at_least_once():
    """Even when there is no time at all."""
    wait_until(lambda: True, timeout=0.0)


@pytest.mark.full
def test_a_busy_machine_is_slow():
    """With ten that compute for each core things take several times as long."""
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(10 * os.cpu_count())]
    try:
        wait_until(lambda: 2.0 < slowness() <= MOST, what="the load to be felt")
    finally:
        for process in busy:
            process.kill()
            process.wait()
