"""Policies that do not plan."""

import pytest

from studies.replay import command, policies
from studies.replay.samples import Fate
from studies.replay.violations import violating
from tests.studies.replay.traffic import POSE, mission, samples, spec

TOLD = sorted([*samples(), *samples(key="r1/pose", size=150, start=100.2)], key=lambda each: each.t)


def flown(name, text):
    told = iter([*TOLD, Fate("r1", 1, "dropped:gone", 0.0)])
    outcomes = policies.enter_all(mission(text), told, 100.0)
    policies.fly(outcomes, name, 21.0, lambda _: None)
    return outcomes, outcomes.columns()


@pytest.mark.parametrize("name", policies.POLICIES)
def test_limits_are_kept_by_all_but_one(name):
    """Each decides every sample once, and what no spec covers goes anyway."""
    outcomes, columns = flown(name, spec())
    assert violating(outcomes, columns).any() == (name == "all")
    assert columns.sent[columns.stream == 1].all()
    planned = columns.sent[columns.stream == 0]
    assert planned.all() if name == "all" else 0 < planned.sum() < len(planned)
    assert {outcomes.reasons[i] for i in columns.fate} <= {"forwarded", "passed", f"dropped:{name}"}
    assert "dropped:gone" in {outcomes.reasons[i] for i in columns.recorded}


def test_what_is_worth_most_by_the_byte_goes_first():
    """A small pose before a large image."""
    _, columns = flown("rank", spec() + POSE)
    assert columns.sent[columns.stream == 1].mean() > columns.sent[columns.stream == 0].mean()


def test_the_command_names_all():
    """It does not import them to know them."""
    assert set(command.POLICIES) == {policies.PLANNER, *policies.POLICIES}
