"""Policies by their names, and what they may know."""

import sys

import pytest

from studies.alone.robot import Robot
from studies.bench.errors import BenchError
from studies.bench.format import read
from studies.bench.policies import Situation, asking, load
from tests.studies.bench.small import write


class Watching:
    """A policy that remembers what it was asked, and sends what fits."""

    def __init__(self):
        self.asked = []

    def decide(self, sample, situation):
        self.asked.append((sample, situation))
        return situation.fits()


@pytest.fixture
def problem(tmp_path):
    """The small mission."""
    return read(write(tmp_path / "small.jsonl")).problem


@pytest.fixture
def policy(tmp_path):
    """Write a file with a policy, and return its name."""

    def written(text, name="Mine"):
        (tmp_path / "mine.py").write_text(text)
        return f"{tmp_path / 'mine.py'}:{name}"

    return written


def test_a_policy_knows_what_was_sent_and_heard(problem):
    """Its own, and of others what arrived; and what it expects of the streams that it heard of."""
    one, other = Robot(problem, 20), Robot(problem, 20)
    told = other.send(other.generate(problem.messages[1]))
    one.hear(told, 0.3)
    window = one.window(one.generate(problem.messages[2]))
    sample, situation = Situation(window).sample, Situation(window)
    assert (sample.robot, sample.stream, sample.t_gen, sample.use) == (0, 0, 1.0, (10_000.0,))
    assert situation.now == 1.0
    assert [(each.stream, each.t_gen, each.arrives) for each in situation.sent] == [(1, 0.25, 0.3)]
    assert situation.shown(0) is None
    assert situation.shown(1) == situation.sent[0]
    assert situation.room() == (5_000.0,)
    assert not situation.fits()
    assert [limit.limit for limit in situation.limits] == [15_000.0]
    assert {each.stream for each in situation.expected} == {0, 1}
    assert sample not in situation.expected


def test_a_policy_knows_nothing_of_those_it_did_not_hear(problem):
    """What another robot sent and nobody received is not there, nor its stream."""
    one, other = Robot(problem, 20), Robot(problem, 20)
    other.send(other.generate(problem.messages[1]))
    situation = Situation(one.window(one.generate(problem.messages[2])))
    assert situation.sent == ()
    assert {each.stream for each in situation.expected} == {0}
    assert situation.room() == (15_000.0,)
    assert situation.fits()


def test_a_sample_says_what_it_is_worth(problem):
    """At a time, and until a time; its weight counted, and nothing before it was generated."""
    robot = Robot(problem, 20)
    sample = Situation(robot.window(robot.generate(problem.messages[3]))).sample
    assert sample.value(1.25) == pytest.approx(3.0)
    assert sample.value(2.25) == pytest.approx(1.5)
    assert sample.worth(1.25, 3.25) == pytest.approx(3.0)
    assert sample.worth(3.25, 3.0) == 0.0


def test_it_is_asked_for_each_decision(problem):
    """And answers for its robot."""
    made = []

    class Known(Watching):
        def __init__(self):
            super().__init__()
            made.append(self)

    robot = Robot(problem, 20)
    decide = asking("known", Known)
    assert decide(robot.window(robot.generate(problem.messages[0]))) is True
    assert len(made) == 1
    ((sample, situation),) = made[0].asked
    assert sample.t_gen == situation.now == 0.0


def test_a_policy_is_found_in_a_file_or_a_module(policy, tmp_path, monkeypatch):
    """A module is looked for in the working directory, too."""
    name = policy("class Mine:\n    def decide(self, sample, situation):\n        return True\n")
    assert load(name).__name__ == "Mine"
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    (tmp_path / "my_own_policy.py").write_text((tmp_path / "mine.py").read_text())
    assert load("my_own_policy:Mine").__name__ == "Mine"


@pytest.mark.parametrize(
    ("text", "wanted", "said"),
    [
        ("class Mine: pass", "Mine", "no class with a method decide(self, sample, situation)"),
        ("class Mine: pass", "Mino", 'has no class "Mino" (did you mean "Mine"?)'),
        ("Mine = 3", "Mine", "no class with a method decide"),
        ("x = 1 / 0", "Mine", "ZeroDivisionError: division by zero (mine.py:1)"),
        ("class Mine", "Mine", "SyntaxError: "),
    ],
)
def test_what_is_no_policy_is_told(policy, text, wanted, said):
    """With its name, and what is wrong."""
    name = policy(text, wanted)
    with pytest.raises(BenchError) as caught:
        load(name)
    assert str(caught.value).startswith(f"policy {name}: ")
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("gredy", "named as module:Class or file.py:Class"),
        ("nowhere.py:Mine", "there is no file nowhere.py"),
        ("no_such_module_here:Mine", "ModuleNotFoundError"),
    ],
)
def test_what_is_not_there_is_told(name, said):
    """Before anything flies."""
    with pytest.raises(BenchError, match=said):
        load(name)


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        ("return None", "decide returned None, neither True nor False"),
        ("return sample.colour", "AttributeError: .* \\(mine.py:3\\)"),
    ],
)
def test_a_policy_that_fails_is_told(policy, problem, answer, said):
    """With its line."""
    name = policy(f"class Mine:\n    def decide(self, sample, situation):\n        {answer}\n")
    robot = Robot(problem, 20)
    with pytest.raises(BenchError, match=said):
        asking(name, load(name))(robot.window(robot.generate(problem.messages[0])))
