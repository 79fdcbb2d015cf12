"""What all tests have in common: threads for Zenoh, how long property tests search, and that no test is left out."""

import os
import signal
from contextlib import ExitStack
from pathlib import Path

import numpy as np  # noqa: F401 - first: a daemon loads it on a thread, and pytest.approx looks at it half loaded
import pytest
import zenoh
from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import providers

# The same examples each time: a failure is what the last change did. New ones are tried by `make qualify`. How long
# anything takes fails no test.
timeless = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("default", timeless, max_examples=12, derandomize=True)
settings.register_profile("full", timeless, max_examples=50, derandomize=True)
settings.register_profile("qualify", timeless, max_examples=3000)
settings.load_profile("default")


def pytest_sessionstart():
    """Have Hypothesis draw the same for a test, whatever ran before it.

    It draws constants of our modules that are loaded by then, which for each process are others, and reads them all for
    the first example: in a fresh clone, on a busy machine and under coverage, that took half a minute.
    """
    if settings.get_current_profile_name() != "qualify":
        assert callable(providers._get_local_constants)
        providers._get_local_constants = lambda: providers._local_constants


def give_threads():
    """Have Zenoh use many threads in this process, but not in those that it starts.

    Dozens of sessions are open here at a time, and links of theirs are cut, of which each keeps a thread for 10 s where
    the session is a plain one. A daemon has two sessions, and these keep none. Zenoh counts its threads when the first
    session of a process opens.
    """
    os.environ["ZENOH_RUNTIME"] = "(tx: (worker_threads: 8), rx: (worker_threads: 64), net: (worker_threads: 4))"
    config = zenoh.Config()
    config.insert_json5("scouting/multicast/enabled", "false")
    config.insert_json5("listen/endpoints", "[]")
    zenoh.open(config).close()
    del os.environ["ZENOH_RUNTIME"]


give_threads()

# What a shell runs in the background ignores Ctrl-C, and so would all that the tests start and end with it.
signal.signal(signal.SIGINT, signal.default_int_handler)

TESTS = Path(__file__).parent
SYSTEM = {"faults", "system", "transparency"}
"""The folders in which `make test-system` looks."""
MIXED = {"faults"}
"""Those that have tests for the other targets, too."""


@pytest.fixture
def stack():
    """What is opened during a test, and closed when it ends."""
    with ExitStack() as opened:
        yield opened


def pytest_collection_modifyitems(items):
    """Refuse a test that no target would run, or one that would run without the root it needs.

    Modules with tests that take long go first: begun last, they would be waited for.
    """
    for item in items:
        folder, marked = item.path.relative_to(TESTS).parts[0], item.get_closest_marker("system") is not None
        if (folder in SYSTEM) != marked and not (folder in MIXED and not marked):
            folders = " or ".join(f"tests/{name}" for name in sorted(SYSTEM))
            raise pytest.UsageError(f"{item.nodeid}: what is in {folders}, and nothing else, is marked `system`")
    long = {item.path for item in items if item.get_closest_marker("full") is not None}
    items.sort(key=lambda item: item.path not in long)
