"""How many files and sockets a daemon may have open."""

import resource
import subprocess
import sys

import pytest

from tests.daemons import Running

LIMITED = """
import resource, sys
from proxy.descriptors import raise_limit
soft, hard, most = map(int, sys.argv[1:])
resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
print(raise_limit(most), *resource.getrlimit(resource.RLIMIT_NOFILE))
"""


@pytest.mark.parametrize(
    ("soft", "hard", "most", "after"), [(200, 600, 500, 500), (200, 400, 500, 400), (600, 600, 500, 600)]
)
def test_the_limit_is_raised_as_far_as_allowed(soft, hard, most, after):
    """Up to the hard limit, and never lowered."""
    command = [sys.executable, "-c", LIMITED, *map(str, (soft, hard, most))]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert said.split() == [str(after), str(after), str(hard)]


def test_a_daemon_raises_its_limit(stack):
    """Those that begin it leave it as low as the system has it."""
    usual = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (256, usual[1]))
    try:
        daemon = Running()
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, usual)
    stack.callback(daemon.end)
    daemon.wait_for("sendworthy: sendworthy ")
    assert resource.prlimit(daemon.process.pid, resource.RLIMIT_NOFILE)[0] > 256
