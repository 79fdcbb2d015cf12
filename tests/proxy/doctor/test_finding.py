"""What was found out."""

from pathlib import Path

import pytest

from proxy.doctor.finding import exit_code, finding, fine, mistake, unknown
from utility_specs.errors import SpecProblem


@pytest.mark.parametrize(
    ("found", "code"),
    [
        ([], 0),
        ([fine("port", "")], 0),
        ([fine("port", ""), unknown("clock", "")], 2),
        ([unknown("clock", ""), finding("port", ""), fine("specs", "")], 1),
    ],
)
def test_the_exit_code_is_that_of_the_worst(found, code):
    """Something to do is more than something that could not be seen."""
    assert exit_code(found) == code


def test_what_this_user_may_not_read_is_no_mistake():
    """The daemon may."""
    barred = SpecProblem(Path("a.toml"), None, "", "cannot be read: Permission denied")
    assert mistake("specs", barred) == unknown("specs", f"{barred}: run it with sudo")
    assert mistake("specs", "a.toml:1: no") == finding("specs", "a.toml:1: no: correct it")


def test_it_is_one_line():
    """Whatever a program says that was asked."""
    assert str(finding("power save", "wlan0:\n  no\tanswer")) == "finding  power save    wlan0: no answer"


def test_a_finding_moves_no_cursor():
    """Names and versions are others' words."""
    assert str(finding("versions", "\x1b[2Jred runs 2.0")) == "finding  versions      \ufffd[2Jred runs 2.0"
