"""Curves in characters."""

import pytest

from utility_specs.terminal_plot import ASCII, BRAILLE, HEIGHT, plot


def label(value):
    return f"{value:g}"


def test_ascii_draws_a_line_without_gaps():
    """Neighbouring columns are joined, and both axes have labels."""
    assert plot([4.0, 4.0, 0.0, 2.0], ["0", "3s"], label, height=4, style=ASCII) == [
        "4 |**",
        "  |  *",
        "2 |  **",
        "  |  *",
        "0 +----",
        "   0 3s",
    ]


def test_braille_has_two_by_four_dots_a_character():
    """Eight columns fit into four characters."""
    lines = plot([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], ["0"], label, height=1, style=BRAILLE)
    assert lines[0] == "1 ┤⢱⣀⣀⡸"
    assert lines[1].endswith("└────")


def test_what_is_worth_nothing_lies_on_the_axis():
    """A curve of zeros has a plot, too."""
    lines = plot([0.0] * 10, ["0", "1"], label, style=ASCII)
    assert len(lines) == HEIGHT + 2
    assert lines[HEIGHT - 1].endswith("**********")


@pytest.mark.parametrize("style", [ASCII, BRAILLE])
def test_labels_stand_at_equal_distances(style):
    """The first at the left end, the last ends at the right one."""
    line = plot([1.0] * 60 * style.across, ["0", "half", "end"], label, style=style)[-1]
    assert line.index("0") == 5
    assert line.index("half") == pytest.approx(5 + 28, abs=1)
    assert len(line) == 5 + 60


def test_a_style_knows_its_characters():
    """So that it can be told whether the output shows them."""
    assert ASCII.sample.isascii()
    assert not BRAILLE.sample.isascii()
