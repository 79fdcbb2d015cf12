"""Daemons of which a thread ends with an error."""

import pytest

from proxy import exit_codes
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
