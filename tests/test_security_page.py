"""SECURITY.md says who can do what, and each row names the test that shows it: that test is there."""

import re
from itertools import pairwise
from pathlib import Path

import pytest

TESTS = Path(__file__).parent
ROWS = [
    line.strip("| ").split(" | ")
    for before, line in pairwise((TESTS.parent / "SECURITY.md").read_text().splitlines())
    if line.startswith("| ") and before.startswith("|")
]
UNCHECKED = ("jam the radio", "publish, hear and ask as the robot does")
"""What no test need show: it is said to be possible."""


@pytest.mark.parametrize("number", range(len(ROWS)))
def test_a_row_names_a_test_that_is_there(number):
    """The row above may have named its file already."""
    question, shown = ROWS[number][0], ROWS[number][-1]
    if question.startswith(UNCHECKED):
        return
    while shown.startswith(("the same", "as above")):
        number -= 1
        shown = ROWS[number][-1]
    named = re.findall(r"`([\w/]+\.py)`: `(test_\w+)`", shown)
    assert named, question
    for file, test in named:
        assert f"def {test}(" in (TESTS / file).read_text(), f"{file}: {test}"
