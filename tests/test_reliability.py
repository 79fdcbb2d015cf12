"""What is promised names tests and commands that are there."""

import re
from importlib.util import find_spec

import pytest

from studies.benchmarks.__main__ import BENCHMARKS
from studies.qualification.stages import STAGES
from tests.docs.pages import ROOT

PAGE = (ROOT / "RELIABILITY.md").read_text()
COMMANDS = sorted(set(re.findall(r"\| `([^`]+)` \| (?:each change|–|2026-\d\d-\d\d) \|", PAGE)))
BENCHMARK = ".venv/bin/python -m studies.benchmarks "
STUDY = ".venv/bin/python -m studies."
TARGETS = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))


def test_every_promise_has_a_command():
    """And the date on which its figure was taken, if it has one."""
    rows = [line for line in PAGE.splitlines() if re.match(r"\| (?!promise|---)", line)]
    assert len(rows) >= 20
    for row in rows:
        assert re.search(r"\| `[^`]+` \| (each change|–|2026-\d\d-\d\d) \|$", row), row


@pytest.mark.parametrize("command", COMMANDS)
def test_commands_run_what_is_there(command):
    """Targets of make, stages of the long runs, benchmarks, files of tests."""
    if command.startswith("make "):
        words = command.split()[1:]
        stages = [word.removeprefix("STAGES=") for word in words if word.startswith("STAGES=")]
        assert {word for word in words if "=" not in word} <= TARGETS
        assert set(stages) <= {stage.name for stage in STAGES}
        return
    if command.startswith(BENCHMARK):
        assert command.removeprefix(BENCHMARK) in BENCHMARKS
        return
    if command.startswith(STUDY):
        assert find_spec(f"studies.{command.removeprefix(STUDY)}")
        return
    path = command.removeprefix(".venv/bin/python -m pytest ")
    assert path != command
    assert (ROOT / path).exists()
