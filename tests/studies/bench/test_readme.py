"""The README of the benchmark: its policy flies, and its mission is one."""

import re
from dataclasses import fields
from pathlib import Path

import pytest

from studies.bench import example
from studies.bench.flying import fly
from studies.bench.format import read
from studies.bench.policies import Sample, Situation
from tests.studies.bench.small import write

ROOT = Path(__file__).parents[3]
README = (ROOT / "studies" / "bench" / "README.md").read_text()


def block(language):
    (found,) = re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)
    return found


def test_its_policy_is_the_one_that_is_shipped_and_flies(tmp_path):
    """Ten lines at most; word for word, but for what linters want to be told."""
    shipped = re.sub(r"  # type: ignore.*", "", Path(example.__file__).read_text()).split("\n\n\n", 1)[1]
    assert block("python") == shipped
    assert len(shipped.splitlines()) <= 10
    (tmp_path / "mine.py").write_text(block("python"))
    score = fly(read(write(tmp_path / "small.jsonl")), f"{tmp_path / 'mine.py'}:Faded")
    assert 0.1 < score.score <= 1.0
    assert 0.0 < score.sent < 1.0


def test_its_mission_is_one(tmp_path):
    """Of the format that is described around it."""
    (tmp_path / "tiny.jsonl").write_text(block("json"))
    mission = read(tmp_path / "tiny.jsonl")
    assert mission.problem.messages[1].scale == 2.0


@pytest.mark.parametrize("name", re.findall(r"situation\.(\w+)", README.split("What the method gets")[1]))
def test_what_it_says_of_situations_is_there(name):
    """By name."""
    assert name in dir(Situation) or name in {field.name for field in fields(Situation)}


@pytest.mark.parametrize("name", re.findall(r"sample\.(\w+)", README.split("What the method gets")[1]))
def test_what_it_says_of_samples_is_there(name):
    """By name."""
    assert hasattr(Sample, name)
