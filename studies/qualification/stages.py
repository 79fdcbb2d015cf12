"""The long runs: what each shows, and the command that shows it."""

import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field

DRAWN = ("--unequal", "--at-most", "1.5")
"""Where teams are drawn, robots are unequal, and no 10 s may hold more than so many times what the limit allows."""
PYTEST = (sys.executable, "-m", "pytest", "--quiet", "--no-header")
WORKERS = 2 * (os.cpu_count() or 1)
"""Tests at a time, as in the Makefile."""
SYSTEM = (*(() if os.geteuid() == 0 else ("sudo", "--preserve-env=KILLS,SOAK")), *PYTEST, "-m", "system")
"""Hosts of their own need root."""


@dataclass(frozen=True, slots=True)
class Stage:
    """A run: what it shows, its command, and what its environment has besides."""

    name: str
    shows: str
    command: tuple[str, ...]
    environment: Mapping[str, str] = field(default_factory=dict)


STAGES = (
    Stage(
        "properties",
        "every property with up to 3,000 examples",
        (
            *(*PYTEST, "-m", "not system", "--hypothesis-profile=qualify", f"--numprocesses={WORKERS}"),
            *("tests/planner", "tests/fuzz", "tests/proxy/core", "tests/utility_specs"),
        ),
    ),
    Stage(
        "reloads",
        "3,000 reloads of specs under 200 samples/s lose and double nothing",
        (*PYTEST, "tests/proxy/test_reloads.py"),
        {"RELOADS": "3000"},
    ),
    Stage(
        "kills",
        "300 times a daemon, an application or a link is lost, and all comes back, each sample at most once",
        (*SYSTEM, "-k", "lost_one_after_the_other", "tests/system/test_restarts.py"),
        {"KILLS": "300"},
    ),
    Stage(
        "faults",
        "100 times a daemon is killed under load, with losses counted exactly; 10,000 keys come at once",
        (*PYTEST, "--capture=no", "tests/faults/test_kills.py", "tests/faults/test_crowds.py", "-k", "kills or keys"),
        {"KILLS": "100", "KEYS": "10000"},
    ),
    Stage(
        "soak",
        "two hours of traffic, of applications that come and go, and of reloads leave nothing behind in a daemon",
        (*SYSTEM, "--capture=no", "tests/system/test_soak.py"),
        {"SOAK": "7200"},
    ),
    Stage(
        "arm64",
        "the package for arm64, emulated: it is installed, serves, and decides as one for x86_64 does, to the last bit",
        ("tests/system/run",),
        {"ARM64": "1", "ONLY": "tests/system/test_arm64.py"},
    ),
    Stage(
        "fuzzing",
        "an hour: what comes over the mesh, specs, configurations, recordings, payloads, images",
        ("tests/fuzz/run", "3600"),
    ),
    Stage(
        "study",
        "what teams reach on bad networks, in view.md beside this page",
        (sys.executable, "-m", "studies.benchmarks", "view"),
    ),
    Stage(
        "teams",
        "simulated teams of up to 12 unequal robots keep to a limit for two minutes",
        (sys.executable, "-m", "studies.simulation.traffic.drawn", *DRAWN, "--seeds", "60", "--seconds", "110"),
    ),
    Stage(
        "daemons",
        "teams of up to 12 unequal real daemons do so for half a minute",
        (sys.executable, "-m", "studies.benchmarks.traffic.drawn", *DRAWN, "--seeds", "10"),
    ),
    Stage(
        "demo",
        "a flight of two minutes",
        ("sendworthy", "demo", "--seconds", "120", "--json", "build/qualify/demo.json"),
    ),
)
