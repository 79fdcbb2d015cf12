"""Which streams a question means, and what is said where it means none."""

import json

import pytest

from proxy import why
from proxy.core.core import Core
from proxy.core.interface import events as ev
from proxy.core.model.mode import Mode
from proxy.core.model.settings import CoreSettings
from proxy.tuning import TUNING
from proxy.why import Question, QuestionError, answer, meant, read
from utility_specs import load_specs

SPECS = """
[[information_type]]
name = "camera"
keys = ["robot/*/camera/*", "robot/*/map"]
utility = { kind = "video" }
[[information_type]]
name = "stop"
keys = ["robot/*/stop"]
utility = { kind = "video" }
bypass = true
"""


@pytest.fixture
def core(tmp_path):
    file = tmp_path / "specs.toml"
    file.write_text(SPECS)
    core = Core(CoreSettings("r1", "z-r1"), load_specs(file), 0.0)
    for number, key in enumerate(("robot/r1/camera/left", "robot/r1/camera/right", "robot/r1/map")):
        core.handle(ev.SamplePublished(0.1, number, key, 100, 0.1, None, 5, {}))
    core.view.streams.touch(0.3, "r2", "robot/r2/map")
    return core


@pytest.mark.parametrize(
    ("asked", "keys"),
    [
        ("robot/r1/map", ["robot/r1/map"]),
        ("left", ["robot/r1/camera/left"]),
        ("robot/*/camera/*", ["robot/r1/camera/left", "robot/r1/camera/right"]),
        ("a//b", []),
        ("camera", []),
    ],
)
def test_a_stream_is_named_by_its_key_a_part_or_an_expression(core, asked, keys):
    """A part that several have names none."""
    assert meant(asked, core.decided_keys()) == keys
    assert [each["key"] for each in answer(core, 1.0, Question(asked))["streams"]] == keys


def test_an_expression_that_takes_long_to_compare_means_all():
    """Zenoh took 20 s for ten `**` and one key of forty chunks, and all decisions waited."""
    deep = ["a/" * 40 + "a", "robot/r1/map"]
    assert meant("a/**/" * 40 + "b", deep) == deep


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ("camera", 'is a part of several keys: "robot/r1/camera/left", "robot/r1/camera/right"'),
        ("robot/r1/mpa", '(did you mean "robot/r1/map"?); no information type covers such a key'),
        ("robot/r1/stop", "bypasses the planner"),
        ("robot/r1/camera/rear", "nobody on another robot wants it, or bridge.out denies it or lets it pass"),
        ("robot/r2/map", "is published by robot r2, whose own daemon decides on it"),
        ("a//b", 'no decision was made on "a//b" (known: '),
        ("x/*", 'no decision was made on "x/*" (known: '),
    ],
)
def test_where_no_stream_is_meant_it_is_said_why(core, asked, said):
    """With what may have been meant."""
    assert said in answer(core, 1.0, Question(asked))["problem"]


def test_in_mode_pass_nothing_is_decided_and_that_is_said(core):
    """Of a covered key that no sample of came before."""
    core.handle(ev.ModeChanged(1.0, Mode.PASS))
    assert "in mode pass samples of" in answer(core, 1.0, Question("robot/r1/camera/rear"))["problem"]


def test_of_too_many_streams_some_are_only_named(core, monkeypatch):
    """The answer is bounded."""
    monkeypatch.setattr(why, "TUNING", type(TUNING)(streams_told=1))
    told = answer(core, 1.0, Question("robot/**"))
    assert (len(told["streams"]), told["left_out"]) == (1, ["robot/r1/camera/right", "robot/r1/map"])


def test_of_many_keys_parts_some_are_named(core, monkeypatch):
    """As many as one can read."""
    monkeypatch.setattr(why, "MOST_NAMED", 1)
    assert answer(core, 1.0, Question("robot"))["problem"].endswith('"robot/r1/camera/left" and 2 more')


def test_questions_are_written_and_read():
    """What is not said is as usual."""
    asked = Question("a", 2, 7)
    assert read(asked.write()) == asked
    assert read(b'{"key": "a"}') == Question("a")


@pytest.mark.parametrize(
    "raw",
    [
        b"",
        b"[]",
        b"{}",
        json.dumps({"key": "a", "last": "x"}).encode(),
        b'{"key": "a", "last": Infinity}',
        b"[" * 100_000,
        b"\xff",
    ],
)
def test_what_is_no_question_is_refused(raw):
    """With an example of one."""
    with pytest.raises(QuestionError, match="decisions are asked for with"):
        read(raw)


@pytest.mark.parametrize(("key", "last"), [("", 1), ("a", 0), ("a", 17), ("rob\udcff", 1)])
def test_too_much_is_refused(key, last):
    """And nothing, and what no key can be, too."""
    with pytest.raises(QuestionError):
        Question(key, last)
