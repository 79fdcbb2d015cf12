"""Processes that may take a part of a core only."""

import subprocess
import sys
import time
from pathlib import Path

import pytest

from studies.surveillance.cores import ROOT, CoresError, held_to
from studies.surveillance.flying import processor_time

pytestmark = pytest.mark.system


def test_a_process_takes_no_more_than_its_part():
    """One that never rests; the group is gone afterwards."""
    with subprocess.Popen([sys.executable, "-c", "while True: pass"]) as busy:
        with held_to(0.1, [busy.pid]):
            groups = list(ROOT.rglob(f"*-{busy.pid}"))
            before, started = processor_time(busy.pid), time.monotonic()
            while time.monotonic() - started < 2.0:
                time.sleep(0.1)
            used, passed = processor_time(busy.pid) - before, time.monotonic() - started
        busy.kill()
    assert groups
    assert used < 0.2 * passed
    assert not any(Path(group).exists() for group in groups)


def test_a_process_that_is_gone_is_an_error():
    """It says what does not work."""
    with subprocess.Popen([sys.executable, "-c", ""]) as gone:
        gone.wait()
    with pytest.raises(CoresError, match="control groups"), held_to(0.1, [gone.pid]):
        pass
