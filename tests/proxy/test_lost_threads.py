"""Daemons of which a thread ends with an error."""

import os
import signal
import threading

import pytest

from proxy import exit_codes
from proxy.lost_threads import LostThreads
from tests.daemons import Running
from tests.ports import free_port

PROGRAM = """
import sys
from {module} import {cls}

class Panic(BaseException):
    "What a panic of Zenoh is in Python: no Exception."

def lost(self):
    raise Panic("no routes any more")

{cls}.{method} = lost
from proxy.cli import main
sys.exit(main())
"""


@pytest.mark.full
@pytest.mark.parametrize(
    ("name", "module", "cls", "method"),
    [("loop", "proxy.loop", "Loop", "_run"), ("watch", "proxy.bridge.mirroring", "Mirroring", "_run")],
)
def test_without_a_thread_that_it_needs_a_daemon_ends(name, module, cls, method):
    """It says which, and why, and systemd starts it anew."""
    daemon = Running(program=("-c", PROGRAM.format(module=module, cls=cls, method=method)))
    said = daemon.wait_for(f"the thread {name} ended with an error")
    assert "the daemon ends" in said
    assert "Panic: no routes any more" in said
    daemon.lines += daemon.process.communicate(timeout=60)[1].splitlines(keepends=True)
    assert daemon.process.returncode == exit_codes.BROKEN


def test_without_one_that_only_watches_it_goes_on():
    """That is said, and the daemon stops as it is told to."""
    program = PROGRAM.format(module="proxy.metrics.server", cls="MetricsServer", method="_serve")
    daemon = Running("--metrics.listen", f"127.0.0.1:{free_port()}", program=("-c", program))
    said = daemon.wait_for("the thread metrics ended with an error")
    assert "is not done any more" in said
    assert daemon.status()["robot"]
    assert daemon.end() == exit_codes.OK


@pytest.mark.parametrize(("name", "needed"), [("control", True), ("costly features", False), ("lookout", False)])
def test_the_daemon_ends_where_it_cannot_do_without_the_thread(name, needed, monkeypatch, caplog):
    """Old values of features hold, and nobody looks for who else answers; an operator has to be answered."""
    ended = []
    monkeypatch.setattr(os, "kill", lambda _pid, number: ended.append(number))

    def fail():
        raise Panic

    lost = LostThreads()
    try:
        thread = threading.Thread(target=fail, name=name)
        thread.start()
        thread.join()
    finally:
        lost.close()
    assert lost.any == needed
    assert ended == [signal.SIGTERM] * needed
    assert ("it cannot do without it" in caplog.text) == needed


class Panic(BaseException):
    """What a panic of Zenoh is in Python: no Exception."""
