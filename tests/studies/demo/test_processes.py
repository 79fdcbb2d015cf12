"""Starting and ending the demo's processes."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from studies.demo.processes import DemoError, Troupe
from tests.waiting import wait_until

SAY_AND_WAIT = "import json, os, sys; print(json.dumps({'pid': os.getpid()}), flush=True); sys.stdin.read()"
STUBBORN = "import signal; signal.signal(signal.SIGTERM, signal.SIG_IGN); " + SAY_AND_WAIT
LEADER = """
import sys, time
from pathlib import Path
from studies.demo.processes import Troupe
with Troupe(Path(sys.argv[1])) as troupe:
    print(troupe.start("child", "-c", sys.argv[2]).hear(60.0)["pid"], flush=True)
    time.sleep(60)
"""


def alive(pid):
    """Whether a process runs; one that has ended and waits to be reaped does not."""
    status = Path(f"/proc/{pid}/stat")
    try:
        return status.read_text().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def test_a_process_is_heard_told_and_ended(tmp_path):
    """What it says comes back as data; leaving the troupe ends it."""
    with Troupe(tmp_path) as troupe:
        process = troupe.start("child", "-c", SAY_AND_WAIT)
        assert process.hear(60.0) == {"pid": process.pid}
        process.tell(1.5)
        troupe.check()
    assert not alive(process.pid)


def test_a_stubborn_process_is_killed(tmp_path):
    """Ignoring SIGTERM does not keep a process alive."""
    with Troupe(tmp_path, patience=0.2) as troupe:
        process = troupe.start("child", "-c", STUBBORN)
        process.hear(60.0)
    assert not alive(process.pid)


def test_a_process_that_fails_is_named_with_its_last_words(tmp_path):
    """The error says who, and what it complained about."""
    with Troupe(tmp_path) as troupe:
        process = troupe.start("child", "-c", "import sys; sys.exit('no such radio')")
        with pytest.raises(DemoError, match=r"child did not get ready .* no such radio"):
            process.hear(60.0)

        def ended():
            try:
                troupe.check()
            except DemoError as error:
                return "child ended with code 1: no such radio" in str(error)
            return False

        wait_until(ended, what="the end of the child")


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_no_process_outlives_the_demo(tmp_path, number):
    """Even a demo that is killed leaves no orphan."""
    command = [sys.executable, "-c", LEADER, str(tmp_path), SAY_AND_WAIT]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    with subprocess.Popen(command, stdout=subprocess.PIPE, env=environment) as leader:
        child = int(leader.stdout.readline())
        assert alive(child)
        leader.send_signal(number)
    wait_until(lambda: not alive(child), what="the end of the child")
