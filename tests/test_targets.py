"""Every test is run by a target: `test`, what is left of `test-full`, or `test-system`."""

import subprocess
from pathlib import Path

import pytest

from tests.conftest import SYSTEM, pytest_collection_modifyitems

ROOT = Path(__file__).parent.parent
COVERED = '-m "not system and not full"'
CHOICE = {
    "test": (COVERED,),
    "test-full": (COVERED, "--cov-fail-under=95", '-m "full and not system"'),
    "test-system": ("tests/system/run",),
}


@pytest.mark.parametrize("target", CHOICE)
def test_targets_choose_by_markers(target):
    """`test` takes the quick ones, `test-full` all that need no root, `test-system` those that do.

    What takes long is not covered.
    """
    told = subprocess.run(["make", "--dry-run", target], cwd=ROOT, capture_output=True, text=True, check=True)
    assert all(choice in told.stdout for choice in CHOICE[target])


def test_the_target_that_has_root_looks_where_such_tests_are():
    """In these folders, for what is marked."""
    script = (ROOT / "tests/system/run").read_text()
    assert " ".join(f"tests/{folder}" for folder in sorted(SYSTEM)) in script
    assert "-m system" in script


@pytest.mark.parametrize(("folder", "marked"), [("system", False), ("proxy", True)])
def test_a_test_that_no_target_runs_is_refused(request, monkeypatch, folder, marked):
    """A marker where no target looks for it, and none where it is needed."""
    item = request.node
    monkeypatch.setattr(item, "path", ROOT / "tests" / folder / "test_new.py")
    if marked:
        item.add_marker("system")
    with pytest.raises(pytest.UsageError, match="marked `system`"):
        pytest_collection_modifyitems([item])
