"""Who may know whom: planner ← utility_specs ← proxy ← studies."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
ALLOWED = {
    "planner": {"planner"},
    "utility_specs": {"planner", "utility_specs"},
    "proxy": {"planner", "utility_specs", "proxy"},
    "studies": {"planner", "utility_specs", "proxy", "studies"},
}


def imported(source: Path) -> set[str]:
    names: set[str] = set()
    for node in ast.walk(ast.parse(source.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            names.add(node.module.split(".")[0])
    return names


@pytest.mark.parametrize("room", sorted(ALLOWED))
def test_a_room_imports_only_the_rooms_it_may_know(room):
    """No source file of a room imports a room above it."""
    sources = list((ROOT / room).rglob("*.py"))
    assert sources
    for source in sources:
        foreign = (imported(source) & set(ALLOWED)) - ALLOWED[room]
        assert not foreign, f"{source.relative_to(ROOT)} imports {', '.join(sorted(foreign))}"


@pytest.mark.parametrize("place", ["planner", "proxy/core"])
def test_the_decision_core_knows_no_clock_and_no_randomness(place):
    """Time and seeds are arguments in the planner and in the core."""
    for source in (ROOT / place).rglob("*.py"):
        assert not imported(source) & {"time", "random", "datetime", "threading", "socket"}, source
