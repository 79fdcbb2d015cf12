"""What was found out."""

import pytest

from proxy.doctor.finding import exit_code, finding, fine, unknown


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


def test_it_is_one_line():
    """Whatever a program says that was asked."""
    assert str(finding("power save", "wlan0:\n  no\tanswer")) == "finding  power save    wlan0: no answer"
