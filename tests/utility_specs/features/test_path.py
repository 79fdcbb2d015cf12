"""Paths into documents."""

from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st

from utility_specs.errors import FeatureError
from utility_specs.features.path import follow, many, steps_of


@dataclass
class Message:
    x: float


DOCUMENT = {
    "pose": {"position": [{"x": 1.5}, {"x": 2.5}], "a.b [0]": 7},
    "grid": [[1, 2], [3]],
    "seen": {"left": {"score": 0.2}, "right": {"score": 0.4}},
    "message": Message(3.0),
    3: "three",
}


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("", DOCUMENT),
        ("pose.position[0].x", 1.5),
        ("pose.position[-1].x", 2.5),
        ('pose["a.b [0]"]', 7),
        ('["pose"].position[1]["x"]', 2.5),
        ("pose.position[*].x", [1.5, 2.5]),
        ("grid[1][0]", 3),
        ("grid[*][*]", [1, 2, 3]),
        ("grid[*][1]", [2]),
        ("seen[*].score", [0.2, 0.4]),
        ("seen[*].nothing", []),
        ("message.x", 3.0),
        ("[3]", "three"),
    ],
)
def test_a_path_leads_to_a_value(path, value):
    """Names after dots, indices and names in brackets, [*] for each; elements that lack it are left out."""
    assert follow(DOCUMENT, steps_of(path)) == value
    assert many(steps_of(path)) == ("*" in path)


@pytest.mark.parametrize(
    "path", ["pose.speed", "grid[2]", "grid.x", "pose[0]", "message.y", "pose.position.x", "[3].real", "[3][0]"]
)
def test_a_path_that_leads_nowhere_raises(path):
    """Nothing of Python's own is found, either."""
    with pytest.raises((FeatureError, LookupError)):
        follow(DOCUMENT, steps_of(path))


@pytest.mark.parametrize("path", [".a", "a.", "a..b", "a[", "a[x]", "a[1.5]", "a.[0]", "a]b", "a[0]b", 'a["x]', "a[]"])
def test_what_is_not_a_path_is_refused(path):
    """The message shows one."""
    with pytest.raises(ValueError, match="is not a path; write for example"):
        steps_of(path)


@given(st.text(max_size=30))
def test_any_text_is_a_path_or_is_refused(text):
    """And a path has as many steps as it has names and brackets."""
    try:
        steps = steps_of(text)
    except ValueError:
        return
    assert bool(steps) == bool(text)
