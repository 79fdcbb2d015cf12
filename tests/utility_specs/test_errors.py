"""Problems as they are shown."""

from pathlib import Path

from utility_specs.errors import SpecProblem, SpecsError


def test_a_problem_is_shown_as_file_line_key_message():
    """What is not known is left out, colon included."""
    file = Path("specs.d/camera.toml")
    assert str(SpecProblem(file, 12, "a.b", "is odd")) == "specs.d/camera.toml:12: a.b: is odd"
    assert str(SpecProblem(file, None, "", "is odd")) == "specs.d/camera.toml: is odd"


def test_an_error_has_one_line_for_each_of_its_problems():
    """All problems are told at once."""
    problems = [SpecProblem(Path("a"), 1, "", "x"), SpecProblem(Path("b"), 2, "", "y")]
    assert str(SpecsError(problems)) == "a:1: x\nb:2: y"
    assert SpecsError(problems).problems == tuple(problems)
