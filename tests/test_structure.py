"""Every package of the house: classes are small, and files are short."""

import ast
from pathlib import Path

HOUSE = Path(__file__).parents[1]
PACKAGES = ("planner", "proxy", "studies", "utility_specs")
MOST_METHODS = 20
MOST_LINES = 400
SOURCES = sorted(source for package in PACKAGES for source in (HOUSE / package).rglob("*.py"))


def test_classes_are_small():
    """A class with more methods is two things."""
    for source in SOURCES:
        for node in ast.walk(ast.parse(source.read_text())):
            if isinstance(node, ast.ClassDef):
                methods = sum(isinstance(each, ast.FunctionDef) for each in node.body)
                assert methods <= MOST_METHODS, f"{source}: {node.name} has {methods} methods"


def test_files_are_short():
    """A file that is longer is two things."""
    lines = {source: len(source.read_text().splitlines()) for source in SOURCES}
    assert {source: count for source, count in lines.items() if count > MOST_LINES} == {}


def test_processes_are_new_ones():
    """None is a fork: `studies/processes.py` says why."""
    pools = [str(source.relative_to(HOUSE)) for source in SOURCES if "ProcessPoolExecutor(" in source.read_text()]
    assert pools == ["studies/processes.py"]
