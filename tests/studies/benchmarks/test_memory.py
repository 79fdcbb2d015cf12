"""The memory benchmark tells what is held and what is left behind."""

import subprocess
import sys

import pytest


def test_both_tables_are_measured(measured):
    """Every search names its iterations, nodes and memory; decisions leave next to nothing behind."""
    searches, growth = measured("memory")
    assert [row[0] for row in searches.rows] == ["best", "paper", "paper, reduction paper", "paper, reduction exact"]
    assert all(float(row[3]) <= 8.0 for row in searches.rows)
    assert all(float(row[2]) <= 1.0 for row in growth.rows)


@pytest.mark.full
def test_what_is_held_is_seen():
    """Memory in use grows with what is kept: asked of a process that has nothing to give back."""
    asked = "from studies.benchmarks.memory import resident; before = resident(); kept = b'x' * 20_000_000"
    said = subprocess.run(
        [sys.executable, "-c", f"{asked}; print(resident() - before)"], capture_output=True, check=True
    )
    assert int(said.stdout) > 15_000_000
