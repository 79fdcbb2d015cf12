"""The wheel that `make wheel` makes, in an empty virtual environment."""

import json
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LOCK = ROOT / "deploy" / "debian" / "requirements.lock"

pytestmark = pytest.mark.system


@pytest.fixture(scope="module")
def wheel():
    """The newest one."""
    subprocess.run(["make", "wheel"], cwd=ROOT, check=True, capture_output=True)
    tag = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return max((ROOT / "dist").glob(f"sendworthy-*-{tag}-{tag}-*.whl"), key=lambda path: path.stat().st_mtime)


@pytest.fixture(scope="module")
def run(wheel, tmp_path_factory):
    """Runs a program of an environment with the wheel and its locked dependencies, and returns what that prints."""
    folder = tmp_path_factory.mktemp("empty")
    subprocess.run([sys.executable, "-m", "venv", folder], check=True)

    def program(name, *words):
        command = [folder / "bin" / name, *words]
        return subprocess.run(command, cwd=folder, check=True, stdout=subprocess.PIPE, text=True).stdout

    program("pip", "install", "--quiet", "--require-hashes", "--requirement", LOCK)
    program("pip", "install", "--quiet", "--no-deps", wheel)
    return program


def test_the_command_line_works(run):
    """It knows its version, and checks specs."""
    assert run("sendworthy", "--version").startswith("sendworthy ")
    assert "surveillance.toml" in run("sendworthy", "check", ROOT / "utility_specs" / "surveillance.toml")


def test_both_engines_plan_alike(run):
    """The one in C++ is in it."""
    plans = [json.loads(line) for line in run("python", ROOT / "tests/planner/agreement.py", "9").splitlines()]
    assert len(plans) == 9 * 4
    assert {plan["send"] for plan in plans} == {False, True}


def test_the_licence_is_in_it_and_neither_tests_nor_results(wheel):
    """What is installed is what is used."""
    names = zipfile.ZipFile(wheel).namelist()
    assert [name for name in names if name.endswith("/licenses/LICENSE")]
    assert {name.split("/")[0] for name in names if ".dist-info/" not in name} == {
        *("planner", "proxy", "studies", "utility_specs")
    }
    assert [name for name in names if name.startswith("studies/results")] == []
