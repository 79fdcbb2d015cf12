"""Missions as files."""

import json

import pytest

from planner import Aggregation, Linear
from studies.bench.errors import BenchError
from studies.bench.folder import MISSIONS, names
from studies.bench.format import read, text_of
from tests.studies.bench.small import HEAD, STREAM, lines, write


def test_a_mission_is_read_as_a_problem(tmp_path):
    """Streams, samples with their use and latency, and the limit."""
    mission = read(write(tmp_path / "small.jsonl"))
    problem = mission.problem
    assert mission.robots == ("r0", "r1")
    assert [(s.robot, s.aggregation) for s in problem.streams] == [(0, Aggregation.MOST_RECENT), (1, "most_recent")]
    third = problem.messages[2]
    assert (third.stream, third.t_gen, third.t_rcv, third.use) == (0, 1.0, 1.05, (10_000.0,))
    assert problem.messages[1].scale == 3.0
    assert third.utility == Linear(1.0, 0.5)
    assert [(c.name, c.window, c.limit) for c in problem.constraints] == [("throughput", 0.9, 15_000.0)]
    assert problem.t_end == 12.0


def test_samples_may_have_a_scale_and_a_slope_of_their_own(tmp_path):
    """In columns that the first line names."""
    given = [HEAD | {"columns": ["t_gen", "stream", "size", "slope", "scale"]}, STREAM, [0.5, 0, 10, 0.25, 4.0]]
    (message,) = read(write(tmp_path / "small.jsonl", given)).problem.messages
    assert message.utility == Linear(1.0, 0.25)
    assert message.scale == 4.0


@pytest.mark.parametrize("name", names())
def test_a_mission_is_written_as_it_was_read(name):
    """To the last byte: all of ours."""
    path = MISSIONS / f"{name}.jsonl"
    assert text_of(read(path)) == path.read_text()


def changed(at, **changes):
    """The lines of the small mission, of which one is another table."""
    given = lines()
    given[at] = given[at] | changes
    return given


def sample(*numbers):
    """The lines of the small mission, of which the first sample is this."""
    return [*lines()[:3], list(numbers)]


@pytest.mark.parametrize(
    ("given", "where", "said"),
    [
        (changed(0, format="other"), ":1: format: ", '"sendworthy-bench 1"'),
        (changed(0, loss=1.0), ":1: loss: ", "less than 1"),
        (changed(0, wind=1.0), ":1: wind: ", "not permitted"),
        (changed(0, warm_up=12.0), ":1: warm_up: ", "less than seconds"),
        (changed(0, limits=[]), ":1: limits: ", "at least 1"),
        (changed(0, limits=[{"kind": "energy", "limit": 1.0, "window": 1.0}]), ":1: limits.0.kind: ", "'throughput'"),
        (changed(0, limits=[{"kind": "messages", "limit": 1.5, "window": 1.0}]), ":1: limits.0.limit: ", "whole"),
        (changed(0, columns=["t_gen", "size", "stream"]), ":1: columns: ", "begin with t_gen, stream, size"),
        (changed(0, columns=["t_gen", "stream", "size", "colour"]), ":1: columns: ", "scale, slope may follow"),
        (changed(1, aggregation="newest"), ":2: aggregation: ", "one of most_recent, "),
        (changed(1, weight=0), ":2: weight: ", "greater than 0"),
        (changed(2, utility={"kind": "liner"}), ":3: utility: ", "kind is one of linear, "),
        (changed(2, utility={"kind": "step", "u0": 1.0}), ":3: utility: ", "step has u0, lifetime, not u0"),
        (changed(2, utility={"kind": "step", "u0": 1.0, "lifetime": -1.0}), ":3: utility: ", "lifetime"),
        (changed(2, utility={"kind": "linear", "u0": 1.0, "slope": "1"}), ":3: utility: ", "slope is a number"),
        (changed(2, utility={"kind": "table", "points": [1, 2]}), ":3: utility: ", "points are pairs"),
        (sample(0.0, 0), ":4: ", "3 numbers (t_gen, stream, size), not 2"),
        (sample(0.0, 2, 100), ":4: stream: ", "streams 0 to 1, not 2"),
        (sample(0.0, 0, 100.5), ":4: size: ", "whole number of bytes"),
        (sample(0.0, 0, "big"), ":4: size: ", 'a number from 0 on, not "big"'),
        (sample(-1.0, 0, 100), ":4: t_gen: ", "a number from 0 on, not -1.0"),
        (sample(12.0, 0, 100), ":4: t_gen: ", "ends at 12 s"),
        ([*sample(2.0, 0, 100), [1.0, 0, 100]], ":5: t_gen: ", "1.0 s comes after 2.0 s"),
        ([*lines(), STREAM], ":28: ", "all streams come before"),
        (lines()[:3], ": ", "it has no samples"),
        ([HEAD | {"columns": ["t_gen", "stream", "size", "slope"]}, STREAM, [1.0, 0, 9, 0]], ":3: slope: ", "above 0"),
    ],
)
def test_what_is_wrong_is_told_by_line_and_key(tmp_path, given, where, said):
    """With what is expected."""
    path = write(tmp_path / "wrong.jsonl", given)
    with pytest.raises(BenchError) as caught:
        read(path)
    assert str(caught.value).startswith(f"{path}{where}")
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (b"", "is empty"),
        (b"\xff", "cannot be read: it is no text"),
        (json.dumps(HEAD).encode() + b'\n{"robot"', ":2: no JSON: "),
        (b"[1, 2]\n", ":1: format: "),
    ],
)
def test_what_is_no_mission_is_told(tmp_path, text, said):
    """Whatever it is."""
    path = tmp_path / "none.jsonl"
    path.write_bytes(text)
    with pytest.raises(BenchError, match=said):
        read(path)


def test_a_file_that_is_not_there_is_told(tmp_path):
    """As the system says it."""
    with pytest.raises(BenchError, match="cannot be read: No such file"):
        read(tmp_path / "nowhere.jsonl")
