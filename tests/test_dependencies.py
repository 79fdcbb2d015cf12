"""What Sendworthy depends on is bounded, locked, and the same in every way to install it."""

import re
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

ROOT = Path(__file__).parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
EXTRAS = PROJECT["project"]["optional-dependencies"]
REQUIRED = [Requirement(line) for lines in (PROJECT["project"]["dependencies"], *EXTRAS.values()) for line in lines]
LOCK = (ROOT / "requirements.lock").read_text()
PACKAGED = (ROOT / "deploy" / "debian" / "requirements.lock").read_text()


def locked(lock):
    """The versions of each package in a lock; some depend on the version of Python."""
    found = {}
    for name, version in re.findall(r"^([\w.-]+)(?:\[[\w,]+\])?==([\w.]+)", lock, re.MULTILINE):
        found.setdefault(canonicalize_name(name), []).append(version)
    return found


@pytest.mark.parametrize("required", REQUIRED, ids=str)
def test_each_is_bounded_below_the_major_version_after_the_locked_one(required):
    """The next one may change anything, and nobody has tried it."""
    (bound,) = [Version(part.version) for part in required.specifier if part.operator == "<"]
    for version in map(Version, locked(LOCK)[canonicalize_name(required.name)]):
        assert required.specifier.contains(version)
        assert bound == Version(str(version.major + 1))


def test_a_package_brings_what_the_tests_ran_with():
    """Its lock is part of the one of developers, hash by hash, with the extras that operators use."""
    assert set(PACKAGED.splitlines()) <= set(LOCK.splitlines())
    assert {canonicalize_name(required.name) for required in REQUIRED} - set(locked(PACKAGED)) == {
        canonicalize_name(Requirement(line).name) for extra in ("study", "cluster") for line in EXTRAS[extra]
    }


@pytest.mark.parametrize("lock", [LOCK, PACKAGED])
def test_locks_name_no_registry(lock):
    """Which one is used is for whoever installs."""
    assert "http" not in lock
    assert "--index" not in lock
